#pragma once

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

#include "haptolith/psychometrics/fit_json.h"
#include "haptolith/psychometrics/group/group.h"
#include "haptolith/psychometrics/group/group_difference.h"

namespace haptolith {

/// The person in the middle, the spread between people, and each participant within the group and alone.
/// @param names  of the participants, in their order.
[[nodiscard]] nlohmann::ordered_json groupJson(const GroupFit& group, const std::vector<std::string>& names);

/// A fit for people: a table of estimates and how well it fits.
[[nodiscard]] std::string fitText(const Fit& fit);

/// The same for people: the person in the middle and the spread, then a line for each participant.
[[nodiscard]] std::string groupText(const GroupFit& group, const std::vector<std::string>& names);

/// How Weber fractions, and PSEs as shares of their references, change: ratios, their intervals and Bayes factors.
[[nodiscard]] nlohmann::ordered_json changesJson(const Change& scale, const std::optional<Change>& threshold);
[[nodiscard]] std::string changesText(const std::string& heading, const Change& scale,
                                      const std::optional<Change>& threshold, double confidence);

/// "0.31"; "below 1e-06" for what is smaller than grids resolve.
[[nodiscard]] std::string bayesFactorText(double factor);

/// Several fits to the same answers, best first, for people.
[[nodiscard]] std::string comparisonText(const std::vector<Fit>& fits);

}  // namespace haptolith
