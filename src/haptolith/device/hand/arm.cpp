#include "haptolith/device/hand/arm.h"

namespace haptolith {

Wrench moveArm(const ArmParameters& arm, const Movement& wanted, const Wrench& soil, double strongest_n, double tick_s,
               Movement& tool) noexcept {
  const double lever_squared = arm.lever_m * arm.lever_m;
  const Vec3 pull_n = arm.stiffness_n_m * (wanted.pose.position_m - tool.pose.position_m) +
                      arm.damping_n_s_m * (wanted.twist.linear_m_s - tool.twist.linear_m_s);
  const Vec3 turn_nm =
      lever_squared * arm.stiffness_n_m * rotationBetween(tool.pose.orientation, wanted.pose.orientation) +
      lever_squared * arm.damping_n_s_m * (wanted.twist.angular_rad_s - tool.twist.angular_rad_s);
  Wrench pull{atMost(strongest_n, pull_n), atMost(strongest_n * arm.lever_m, turn_nm)};
  const Vec3 force = pull.force_n + soil.force_n;
  const Vec3 torque = pull.torque_nm + soil.torque_nm;
  tool.twist.linear_m_s += tick_s / arm.mass_kg * force;
  tool.twist.angular_rad_s += tick_s / (arm.mass_kg * lever_squared) * torque;
  tool.pose.position_m += tick_s * tool.twist.linear_m_s;
  tool.pose.orientation = turnedBy(tick_s * tool.twist.angular_rad_s, tool.pose.orientation);
  return pull;
}

double lightestArm(const ArmParameters& arm, double tick_s) noexcept {
  return (arm.stiffness_n_m * tick_s * tick_s + 2 * arm.damping_n_s_m * tick_s) / 4;
}

}  // namespace haptolith
