#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

#include "haptolith/psychometrics/fit.h"

namespace haptolith {

/// Returns a fit as JSON for `study fit --json` and the library: threshold, width, jnd, weber_fraction, lapse, guess,
/// overdispersion, intervals and so on; w for the sigmoids of (paper 22).
[[nodiscard]] nlohmann::ordered_json fitJson(const Fit& fit);

/// Returns [low, high].
[[nodiscard]] nlohmann::ordered_json intervalJson(const Interval& interval);

/// Returns "yesno", "equal-asymptote", "2afc", "3afc" etc.
[[nodiscard]] std::string designName(const Fit& fit);

}  // namespace haptolith
