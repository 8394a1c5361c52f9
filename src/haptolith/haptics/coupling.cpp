#include "haptolith/haptics/coupling.h"

#include <fmt/format.h>

#include <limits>

#include "haptolith/core/error.h"

namespace haptolith {

bool suitsDirectly(const DeviceLimits& device) noexcept {
  constexpr double kLongestDelay_s = 0.001;
  constexpr double kCoarsest_m = 2e-5;  // a step of the shovel's stiffest contact, 8500 N/m, is then 0.2 N
  return device.shows_force && device.delay_s <= kLongestDelay_s && device.resolution_m <= kCoarsest_m;
}

void validate(const CouplingParameters& coupling, double tick_s) {
  const ArmParameters& spring = coupling.spring;
  requireInRange("stiffness_n_m", spring.stiffness_n_m, CouplingRanges::stiffness_n_m);
  requireInRange("damping_n_s_m", spring.damping_n_s_m, CouplingRanges::damping_n_s_m);
  requireInRange("lever_m", spring.lever_m, CouplingRanges::lever_m);
  requireInRange("max_force_n", coupling.max_force_n, CouplingRanges::max_force_n);
  requireInRange("mass_kg", spring.mass_kg, CouplingRanges::mass_kg);
  if (spring.mass_kg <= lightestArm(spring, tick_s)) {
    throw InvalidParameter("mass_kg", fmt::format("{:g}", spring.mass_kg),
                           fmt::format("> {:g}, or the coupling is numerically unstable at a tick of {:g} s",
                                       lightestArm(spring, tick_s), tick_s));
  }
}

Coupling::Coupling(const CouplingParameters& parameters, bool suits_directly, double filter_cutoff_hz, double tick_s)
    : coupling_(parameters),
      virtual_(couplesVirtually(parameters.kind, suits_directly)),
      tick_s_(tick_s),
      filter_(filter_cutoff_hz, tick_s),
      grip_filter_(filter_cutoff_hz, tick_s),
      quick_movement_(tick_s) {
  validate(parameters, tick_s);
}

const HandState& Coupling::moveTool(const HandState& hand) noexcept {
  if (virtual_) {
    pull_ = moveArm(coupling_.spring, hand, soil_, coupling_.max_force_n, tick_s_, tool_);
    tool_.opening = hand.opening;
  } else {
    tool_ = hand;
  }
  return tool_;
}

ToolForce Coupling::feel(const ToolForce& soil, const Eigen::Matrix3d& contact_stiffness_n_m) noexcept {
  soil_ = soil.wrench;
  const double grip_n = grip_filter_.step(soil.grip_n);
  if (virtual_) {
    return {{-pull_.force_n, -pull_.torque_nm}, grip_n};
  }
  const Vec3 own_change_n = -tick_s_ * contact_stiffness_n_m * quick_movement_.step(tool_.twist.linear_m_s);
  return {filter_.step(soil.wrench, own_change_n), grip_n};
}

double Coupling::stiffness() const noexcept {
  return virtual_ ? coupling_.spring.stiffness_n_m : std::numeric_limits<double>::infinity();
}

void Coupling::place(const HandState& hand) noexcept {
  tool_ = {{hand.pose, {}}, hand.opening};
  soil_ = {};
  pull_ = {};
}

}  // namespace haptolith
