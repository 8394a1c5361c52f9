#include "haptolith/teleop/robot/simulated_arm.h"

namespace haptolith {

namespace {

bool isFinite(const Movement& tool) noexcept {
  return tool.pose.position_m.allFinite() && tool.pose.orientation.coeffs().allFinite() &&
         tool.twist.linear_m_s.allFinite() && tool.twist.angular_rad_s.allFinite();
}

Pose lifted(Pose pose, double by_m) noexcept {
  pose.position_m.z() += by_m;
  return pose;
}

}  // namespace

SimulatedArm::SimulatedArm(const ArmParameters& arm, double max_force_n, const ForceSensorParameters& sensor,
                           Scene& scene, double surface_m, const Pose& home)
    : arm_(arm),
      max_force_n_(max_force_n),
      scene_(scene),
      surface_m_(surface_m),
      tick_s_(scene.bed().parameters().tick_s),
      sensor_(sensor, scene.bed().parameters().gravity_m_s2, tick_s_),
      tool_{home, {}} {
  scene_.placeTool({{lifted(home, surface_m_), {}}, 1});
}

ArmReading SimulatedArm::move(const HandState& wanted, bool /*commanded*/) noexcept {
  // Its joints carry the tool's weight and feel the soil.
  const Wrench pull = moveArm(arm_, wanted, scene_.soilWrench(), max_force_n_, tick_s_, tool_);
  const bool at_force_cap = pull.force_n.norm() >= max_force_n_ * (1 - 1e-9);
  if (!isFinite(tool_)) {
    return {tool_, met_, at_force_cap, true};  // the bed never learns of it
  }
  HandState hand{tool_, wanted.opening};
  hand.pose = lifted(hand.pose, surface_m_);
  const StepStatus status = scene_.tick(hand);
  met_ = sensor_.read(scene_.soilWrench(), tool_);
  return {tool_, met_, at_force_cap,
          status != StepStatus::kOk || !met_.force_n.allFinite() || !met_.torque_nm.allFinite()};
}

}  // namespace haptolith
