#include "haptolith/device/hand/hand_parameters.h"

#include "haptolith/core/error.h"

namespace haptolith {

void validate(const HandParameters& hand) {
  requireInRange("mass_kg", hand.mass_kg, HandRanges::mass_kg);
  requireInRange("damping_n_s_m", hand.damping_n_s_m, HandRanges::damping_n_s_m);
  requireInRange("stiffness_n_m", hand.stiffness_n_m, HandRanges::stiffness_n_m);
  requireInRange("lever_m", hand.lever_m, HandRanges::lever_m);
  requireInRange("period_s", hand.period_s, HandRanges::period_s);
  requireInRange("active_s", hand.active_s, HandRanges::active_s);
  for (int axis = 0; axis < 3; ++axis) {
    requireInRange("home_m", hand.home_m[axis], HandRanges::home_m);
    requireInRange("turn_rad", hand.turn_rad[axis], HandRanges::turn_rad);
  }
  requireInRange("depth_m", hand.depth_m, HandRanges::depth_m);
  requireInRange("surface_m", hand.surface_m.value_or(0), HandRanges::surface_m);
  requireInRange("reach_m", hand.reach_m, HandRanges::reach_m);
  requireInRange("max_force_n", hand.max_force_n, HandRanges::max_force_n);
  requireInRange("max_torque_nm", hand.max_torque_nm, HandRanges::max_torque_nm);
  if (hand.motion == HandMotion::kPoses && hand.poses_file.empty()) {
    throw InvalidParameter("poses", "''", "the name of a CSV file with poses");
  }
}

ArmParameters armOf(const HandParameters& hand) noexcept {
  return {hand.mass_kg, hand.damping_n_s_m, hand.stiffness_n_m, hand.lever_m};
}

}  // namespace haptolith
