#include "haptolith/tool/joint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "haptolith/core/turn.h"

namespace haptolith {

void validate(const Joint& joint) {
  constexpr double kRounding = 1e-6;
  if (!(std::abs(joint.axis.norm() - 1) < kRounding)) {
    throw InvalidParameter("joint_axis",
                           fmt::format("({:g}, {:g}, {:g})", joint.axis.x(), joint.axis.y(), joint.axis.z()),
                           "a unit vector");
  }
  for (int axis = 0; axis < 3; ++axis) {
    requireInRange("joint_point_m", joint.point_m[axis], JointRanges::point_m);
  }
  requireInRange("joint_speed_rad_s", joint.speed_rad_s, JointRanges::speed_rad_s);
  requireInRange("joint_torque_nm", joint.torque_nm, JointRanges::torque_nm);
  if (joint.drive == Drive::kTorque || joint.drive == Drive::kFree) {
    requireInRange("joint_inertia_kg_m2", joint.inertia_kg_m2, JointRanges::inertia_kg_m2);
  }
}

Pose turned(const Pose& scene_T_hub, const Joint& joint, double angle_rad) noexcept {
  const Quat turn = turnAbout(joint.axis, angle_rad);
  return {scene_T_hub.fromBody(joint.point_m - turn * joint.point_m), (scene_T_hub.orientation * turn).normalized()};
}

Twist turning(const Pose& scene_T_hub, const Twist& hub, const Joint& joint, double speed_rad_s,
              const Pose& scene_T_tool) noexcept {
  const Vec3 spin_rad_s = scene_T_hub.orientation * (speed_rad_s * joint.axis);
  const Vec3 from_axis_m = scene_T_tool.position_m - scene_T_hub.fromBody(joint.point_m);
  return {hub.at(scene_T_tool.position_m - scene_T_hub.position_m) + spin_rad_s.cross(from_axis_m),
          hub.angular_rad_s + spin_rad_s};
}

double torqueAboutAxis(const Pose& scene_T_hub, const Joint& joint, const Pose& scene_T_tool,
                       const Wrench& on_tool) noexcept {
  const Vec3 from_axis_m = scene_T_tool.position_m - scene_T_hub.fromBody(joint.point_m);
  return (scene_T_hub.orientation * joint.axis).dot(on_tool.torque_nm + from_axis_m.cross(on_tool.force_n));
}

void turn(JointState& state, double dt_s) noexcept {
  constexpr double kTurn = 2 * std::numbers::pi;
  state.angle_rad += state.speed_rad_s * dt_s;
  if (std::abs(state.angle_rad) > std::numbers::pi) {
    state.angle_rad -= std::copysign(kTurn, state.angle_rad);
  }
}

double drive(const Joint& joint, JointState& state, double soil_torque_nm, double dt_s) noexcept {
  if (joint.drive == Drive::kSpeed) {
    return -soil_torque_nm;
  }
  const double motor_nm = joint.drive == Drive::kTorque ? joint.torque_nm : 0;
  const double speed_rad_s = state.speed_rad_s + dt_s * (motor_nm + soil_torque_nm) / joint.inertia_kg_m2;
  state.speed_rad_s = std::clamp(speed_rad_s, JointRanges::speed_rad_s.lowest, JointRanges::speed_rad_s.highest);
  return motor_nm;
}

}  // namespace haptolith
