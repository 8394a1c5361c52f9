#include "haptolith/haptics/safety/plausibility.h"

#include <algorithm>

#include "haptolith/core/movement.h"

namespace haptolith {

namespace {

constexpr double kFastest_m_s = 10;
constexpr double kHand_m = 0.1;             ///< distance of the handle from the wrist
constexpr double kLargestJump = 0.3;        ///< largest change of velocity in a tick, as a fraction of the maximum
constexpr double kContradiction_s = 0.004;  ///< at the maximum velocity
constexpr double kForgotten_s = 0.1;

}  // namespace

Plausibility::Plausibility(double rate_hz, double tick_s) : tick_s_(tick_s), step_s_(std::max(tick_s, 1 / rate_hz)) {
  way_.fastest = kFastest_m_s;
  turn_.fastest = kFastest_m_s / kHand_m;
}

bool Plausibility::observe(const DeviceInput& input) noexcept {
  if (!known_) {
    known_ = true;
    way_.velocity = input.twist.linear_m_s;
    turn_.velocity = input.twist.angular_rad_s;
    way_.promised = turn_.promised = Vec3::Zero();
    pose_ = input.pose;
  }
  const Vec3 way_m = input.pose.position_m - pose_.position_m;
  const Vec3 turn_rad = rotationBetween(pose_.orientation, input.pose.orientation);
  pose_ = input.pose;
  const bool moves = way_.add(way_m, input.twist.linear_m_s, tick_s_, step_s_);
  const bool turns = turn_.add(turn_rad, input.twist.angular_rad_s, tick_s_, step_s_);
  return moves && turns;
}

bool Plausibility::Account::add(const Vec3& made, const Vec3& velocity_now, double tick_s, double step_s) noexcept {
  const Vec3 jump = velocity_now - velocity;
  velocity = velocity_now;
  promised *= 1 - tick_s / kForgotten_s;
  const Vec3 left = promised + tick_s * velocity_now - made;
  const double step = fastest * step_s;
  const bool as_fast_as_a_hand = velocity_now.norm() <= fastest && jump.norm() <= kLargestJump * fastest &&
                                 (made.norm() <= step || left.norm() <= step);
  if (!velocity_now.isZero(0) || left.norm() < promised.norm()) {
    promised = left;
  }
  if (as_fast_as_a_hand && promised.norm() <= kContradiction_s * fastest) {
    return true;
  }
  promised.setZero();  // tripped; later readings are judged afresh
  return false;
}

}  // namespace haptolith
