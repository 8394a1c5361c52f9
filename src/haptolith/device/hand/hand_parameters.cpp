#include "haptolith/device/hand/hand_parameters.h"

#include "haptolith/core/error.h"

namespace haptolith {

void validate(const HandParameters& hand) {
  constexpr double kInfinity = Range{}.highest;
  requireInRange("mass_kg", hand.mass_kg, {0.01, 100});
  requireInRange("damping_n_s_m", hand.damping_n_s_m, {0, 1000});
  requireInRange("stiffness_n_m", hand.stiffness_n_m, {0, 1e5});
  requireInRange("lever_m", hand.lever_m, {0.005, 1});
  requireInRange("period_s", hand.period_s, {0.1, 3600});
  requireInRange("active_s", hand.active_s, {0, kInfinity});
  for (int axis = 0; axis < 3; ++axis) {
    requireInRange("home_m", hand.home_m[axis], {-10, 10});
  }
  requireInRange("depth_m", hand.depth_m, {0, 10});
  requireInRange("surface_m", hand.surface_m.value_or(0), {-10, 10});
  requireInRange("reach_m", hand.reach_m, {0, 10});
  requireInRange("max_force_n", hand.max_force_n, {0, 1e6});
  requireInRange("max_torque_nm", hand.max_torque_nm, {0, 1e6});
  if (hand.manoeuvre == Manoeuvre::kPoses && hand.poses_file.empty()) {
    throw InvalidParameter("poses", "''", "the name of a CSV file with poses");
  }
}

}  // namespace haptolith
