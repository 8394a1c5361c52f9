#include "haptolith/haptics/passivity.h"

#include <algorithm>
#include <cmath>

#include "haptolith/device/arm.h"

namespace haptolith {

namespace {

/// The strongest damper, in N s/m: with an output that is 5 ms late it still damps whatever weighs more than 0.08 kg
/// (alpha < pi m / (2 T)), and no handle is lighter.
constexpr double kStrongest_n_s_m = 20;

constexpr double kForgetting_s = 0.25;
constexpr double kForgiven_j = 2e-3;
constexpr double kForgivenAgain_j = 0.2e-3;
constexpr double kForgiveness_s = 2;

/// Joins turning to moving: a handle's radius of gyration, about.
constexpr double kLever_m = 0.05;

/// What a hand that has paid nothing yet may be given by a force that comes late.
constexpr double kCredit_j = 0.5e-3;
constexpr double kLightestHandle_kg = 0.1;

double squaredSpeed(const Twist& twist) noexcept {
  return twist.linear_m_s.squaredNorm() + kLever_m * kLever_m * twist.angular_rad_s.squaredNorm();
}

/// The damper that takes `excess_j` out of this movement within a tick, or as much as it may.
Wrench damper(double excess_j, const Twist& twist, double tick_s) noexcept {
  const double speed_squared = squaredSpeed(twist);
  if (excess_j <= 0 || speed_squared == 0) {
    return {};
  }
  const double alpha = std::min(excess_j / (tick_s * speed_squared), kStrongest_n_s_m);
  return {-alpha * twist.linear_m_s, -alpha * kLever_m * kLever_m * twist.angular_rad_s};
}

}  // namespace

Passivity::Passivity(double stiffness_n_m, double delay_s, double tick_s) noexcept
    : stiffness_n_m_(stiffness_n_m),
      tick_s_(tick_s),
      quick_velocity_(tick_s),
      quick_rotation_(tick_s),
      quick_force_(tick_s),
      quick_torque_(tick_s),
      delay_(std::min(static_cast<std::size_t>(std::lround(delay_s / tick_s)), sent_.size() - 1)),
      forgiven_j_(kForgiven_j) {}

void Passivity::observe(const Pose& device, const Wrench& sent) noexcept {
  sent_[calls_ % sent_.size()] = sent;
  const Wrench& held = sent_[(calls_ + sent_.size() - delay_) % sent_.size()];
  ++calls_;
  if (known_) {
    twist_ = {(device.position_m - last_.position_m) / tick_s_,
              rotationBetween(last_.orientation, device.orientation) / tick_s_};
    quick_twist_ = {quick_velocity_.step(twist_.linear_m_s), quick_rotation_.step(twist_.angular_rad_s)};
    const Vec3 quick_n = quick_force_.step(held.force_n);
    const Vec3 quick_nm = quick_torque_.step(held.torque_nm);
    whole_j_ += tick_s_ * (held.force_n.dot(twist_.linear_m_s) + held.torque_nm.dot(twist_.angular_rad_s));
    quick_j_ += tick_s_ * (quick_n.dot(quick_twist_.linear_m_s) + quick_nm.dot(quick_twist_.angular_rad_s));
    const double held_squared = quick_n.squaredNorm() + quick_nm.squaredNorm() / (kLever_m * kLever_m);
    quick_j_ *= 1 - tick_s_ / kForgetting_s;
    quick_j_ = std::max(quick_j_, -held_squared / (2 * stiffness_n_m_));
    forgiven_j_ = quick_j_ > forgiven_j_ ? kForgivenAgain_j
                                         : forgiven_j_ + (kForgiven_j - forgiven_j_) * tick_s_ / kForgiveness_s;
  }
  last_ = device;
  known_ = true;
}

void Passivity::restart() noexcept {
  const double spent_j = std::min(0.0, whole_j_);  // a jump to elsewhere is no error to be made good
  *this = Passivity(stiffness_n_m_, static_cast<double>(delay_) * tick_s_, tick_s_);
  whole_j_ = spent_j;
}

double Passivity::affordable(const Wrench& wrench) const noexcept {
  const double late_s = static_cast<double>(delay_) * tick_s_;
  const double asked_n =
      std::sqrt(wrench.force_n.squaredNorm() + wrench.torque_nm.squaredNorm() / (kLever_m * kLever_m));
  if (late_s == 0 || asked_n == 0) {
    return 1;
  }
  // What is on its way already, and how it will move the handle.
  Twist twist = twist_;
  double given_j = whole_j_;
  for (std::size_t age = delay_; age > 0; --age) {
    const Wrench& on_its_way = sent_[(calls_ + sent_.size() - age) % sent_.size()];
    given_j += tick_s_ * (on_its_way.force_n.dot(twist.linear_m_s) + on_its_way.torque_nm.dot(twist.angular_rad_s));
    twist.linear_m_s += tick_s_ / kLightestHandle_kg * on_its_way.force_n;
    twist.angular_rad_s += tick_s_ / (kLightestHandle_kg * kLever_m * kLever_m) * on_its_way.torque_nm;
  }
  const double speed_squared = std::max(squaredSpeed(twist), squaredSpeed(twist_));
  const double left_j = std::max(0.0, kCredit_j - std::max(given_j, whole_j_));
  const double gain_m_s = std::sqrt(speed_squared + 2 * left_j / kLightestHandle_kg) - std::sqrt(speed_squared);
  return std::min(1.0, kLightestHandle_kg * gain_m_s / (late_s * asked_n));
}

Wrench Passivity::damping() const noexcept {
  Wrench sum = damper(whole_j_, twist_, tick_s_);
  const Wrench quick = damper(quick_j_ - forgiven_j_, quick_twist_, tick_s_);
  sum.force_n += quick.force_n;
  sum.torque_nm += quick.torque_nm;
  return sum;
}

}  // namespace haptolith
