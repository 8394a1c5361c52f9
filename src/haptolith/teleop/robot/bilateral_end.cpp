#include "haptolith/teleop/robot/bilateral_end.h"

namespace haptolith {

double BilateralEnd::excess(double out_j) noexcept {
  if (out_j <= 0) {
    in_j_ -= out_j;
    return 0;
  }
  const double excess_j = std::clamp(out_j - margin(), 0.0, out_j);
  out_j_ += out_j - excess_j;
  dissipated_j_ += excess_j;
  return excess_j;
}

Wrench BilateralEnd::damp(const Wrench& shown, const Twist& twist) noexcept {
  const double power_w = shown.force_n.dot(twist.linear_m_s) + shown.torque_nm.dot(twist.angular_rad_s);
  const double excess_j = excess(tick_s_ * power_w);
  if (excess_j == 0) {
    return shown;
  }
  const double lever_squared = lever_m_ * lever_m_;
  const double square = twist.linear_m_s.squaredNorm() + lever_squared * twist.angular_rad_s.squaredNorm();
  const double damper_n_s_m = excess_j / (tick_s_ * square);
  return {shown.force_n - damper_n_s_m * twist.linear_m_s,
          shown.torque_nm - damper_n_s_m * lever_squared * twist.angular_rad_s};
}

Twist BilateralEnd::brake(const Twist& moved, const Wrench& load) noexcept {
  const double power_w = -(load.force_n.dot(moved.linear_m_s) + load.torque_nm.dot(moved.angular_rad_s));
  const double excess_j = excess(tick_s_ * power_w);
  if (excess_j == 0) {
    return moved;
  }
  const double lever_squared = lever_m_ * lever_m_;
  const double square = load.force_n.squaredNorm() + load.torque_nm.squaredNorm() / lever_squared;
  const double mobility_m_n_s = excess_j / (tick_s_ * square);
  return {moved.linear_m_s + mobility_m_n_s * load.force_n,
          moved.angular_rad_s + mobility_m_n_s / lever_squared * load.torque_nm};
}

}  // namespace haptolith
