#include "haptolith/identify/training/soil_state.h"

#include <algorithm>
#include <cmath>

namespace haptolith {

namespace {

constexpr double kDensity_kg_m3 = 1500;
constexpr double kLength_m = 0.03;  ///< digging depth; smaller cohesion is negligible compared with weight

StateVector vectorOf(double angle_deg, double cohesion_m, double tool_friction) {
  return {angle_deg, std::log(cohesion_m + kLength_m), tool_friction};
}

}  // namespace

StateVector stateVector(const SoilState& state, double gravity_m_s2) {
  return vectorOf(state.friction_angle_deg, state.cohesion_pa / (kDensity_kg_m3 * gravity_m_s2), state.tool_friction);
}

SoilState soilState(const StateVector& vector, double gravity_m_s2) {
  const double cohesion_m = std::max(0.0, std::exp(vector[1]) - kLength_m);
  return {vector[0], cohesion_m * kDensity_kg_m3 * gravity_m_s2, vector[2]};
}

StateVector lowest(const SoilPrior& prior) {
  return vectorOf(prior.friction_angle_deg.lowest, prior.cohesion_m.lowest, prior.tool_friction.lowest);
}

StateVector highest(const SoilPrior& prior) {
  return vectorOf(prior.friction_angle_deg.highest, prior.cohesion_m.highest, prior.tool_friction.highest);
}

}  // namespace haptolith
