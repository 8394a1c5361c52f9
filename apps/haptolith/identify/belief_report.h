#pragma once

#include <nlohmann/json.hpp>

#include <string>

#include "haptolith/identify/soil_belief.h"

namespace haptolith {

/// Returns a belief about a soil as text, one line per quantity, with its interval.
[[nodiscard]] std::string beliefText(const SoilBelief& belief, const SoilPrior& prior, double gravity_m_s2);
[[nodiscard]] nlohmann::ordered_json beliefJson(const SoilBelief& belief, const SoilPrior& prior, double gravity_m_s2);

}  // namespace haptolith
