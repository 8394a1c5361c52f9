#include "haptolith/device/drivers/rate_control.h"

#include <algorithm>
#include <cmath>

#include "haptolith/core/error.h"
#include "haptolith/core/math/portable_math.h"

namespace haptolith {

namespace {

/// Nearer to its target than this in m and rad the handle is there: otherwise it would creep on for ever.
constexpr double kThere = 1e-9;

Vec3 response(const Vec3& deflection, double dead_zone) noexcept {
  const double size = deflection.norm();
  if (!std::isfinite(size) || size <= dead_zone) {
    return Vec3::Zero();
  }
  const double s = std::min(1.0, (size - dead_zone) / (1 - dead_zone));
  return s * s / size * deflection;
}

}  // namespace

Twist rateOf(const Deflection& deflection, const RateParameters& parameters) noexcept {
  return {parameters.max_speed_m_s * response(deflection.linear, parameters.dead_zone),
          parameters.max_turn_rad_s * response(deflection.angular, parameters.dead_zone)};
}

SteeredHandle::SteeredHandle(double tick_s, double workspace_radius_m)
    : tick_s_(requireInRange("tick_s", tick_s, {.lowest = 0, .highest = 0.1, .ends = Ends::kOpenBelow})),
      workspace_radius_m_(
          requireInRange("workspace_radius_m", workspace_radius_m, {.lowest = 0, .ends = Ends::kOpenBelow})),
      share_(1 - portable::exp(-tick_s / kSmoothing_s)) {}

DeviceLimits SteeredHandle::limits() noexcept {
  DeviceLimits limits;
  limits.max_force_n = 0;
  limits.shows_force = false;
  limits.max_torque_nm = 0;
  limits.max_gripper_force_n = 0;
  limits.workspace_radius_m = kWorkspaceRadius_m;
  return limits;
}

const Movement& SteeredHandle::drive(const Twist& speed) noexcept {
  target_.orientation = turnedBy(tick_s_ * speed.angular_rad_s, target_.orientation);
  return displace(tick_s_ * speed.linear_m_s);
}

const Movement& SteeredHandle::displace(const Vec3& by_m) noexcept {
  if (by_m.allFinite()) {
    target_.position_m = atMost(workspace_radius_m_, target_.position_m + by_m);
  }
  return follow();
}

const Movement& SteeredHandle::follow() noexcept {
  const Pose before = handle_.pose;
  const Vec3 rest_m = target_.position_m - before.position_m;
  const Vec3 rest_rad = rotationBetween(before.orientation, target_.orientation);
  if (rest_m.norm() < kThere && rest_rad.norm() < kThere) {
    handle_.pose = target_;
  } else {
    handle_.pose.position_m += atMost(kMaxSpeed_m_s * tick_s_, share_ * rest_m);
    handle_.pose.orientation = turnedBy(share_ * rest_rad, before.orientation);
  }
  handle_.twist = {(handle_.pose.position_m - before.position_m) / tick_s_,
                   rotationBetween(before.orientation, handle_.pose.orientation) / tick_s_};
  return handle_;
}

}  // namespace haptolith
