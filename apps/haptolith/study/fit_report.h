#pragma once

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

#include "haptolith/psychometrics/fit_json.h"
#include "haptolith/psychometrics/group/group.h"
#include "haptolith/psychometrics/group/group_difference.h"

namespace haptolith {

/// Returns the median participant, the spread between participants, and each participant within the group and alone.
/// @param names  names of the participants, in their order.
[[nodiscard]] nlohmann::ordered_json groupJson(const GroupFit& group, const std::vector<std::string>& names);

/// Returns a fit as text: a table of estimates, and goodness of fit.
[[nodiscard]] std::string fitText(const Fit& fit);

/// Returns a group as text: the median participant and the spread, then one line per participant.
[[nodiscard]] std::string groupText(const GroupFit& group, const std::vector<std::string>& names);

/// Returns changes of Weber fractions, and of PSEs over their references: ratios, their intervals and Bayes factors.
[[nodiscard]] nlohmann::ordered_json changesJson(const Change& scale, const std::optional<Change>& threshold);
[[nodiscard]] std::string changesText(const std::string& heading, const Change& scale,
                                      const std::optional<Change>& threshold, double confidence);

/// Returns "0.31"; "below 1e-06" below the resolution of the grids.
[[nodiscard]] std::string bayesFactorText(double factor);

/// Returns several fits to the same responses as text, best first.
[[nodiscard]] std::string comparisonText(const std::vector<Fit>& fits);

}  // namespace haptolith
