#pragma once

#include "haptolith/core/vec.h"
#include "haptolith/device/hand/arm.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Deflection of sticks and pucks as a fraction of their range: -1 to 1 along and about the axes of
/// the device's frame.
struct Deflection {
  Vec3 linear = Vec3::Zero();
  Vec3 angular = Vec3::Zero();
};

/// Mapping of a deflection to a speed.
struct RateParameters {
  double dead_zone = 0.1;       ///< 0 <= share < 1 of the deflection that is still rest
  double max_speed_m_s = 0.15;  ///< at full deflection
  double max_turn_rad_s = 1.5;
};

/// The requested speed, in the device frame. For linear and angular deflection d separately
///
///     v = v_max s^2 d / |d|,    s = (|d| - d_0) / (1 - d_0), between 0 and 1,        d_0: dead zone
///
/// In the frame of the deflection, the device frame. Along d, so that the response is the same in all directions; its
/// slope is 0 where it begins, so that little pushes are fine ones. Rest for a deflection that is not finite. May be
/// called in the tick.
[[nodiscard]] Twist rateOf(const Deflection& deflection, const RateParameters& parameters) noexcept;

/// The virtual handle of a device without one: moved by speeds (drive()) or by distances (displace()), once a
/// tick. It begins at the origin, unturned, and stays in a sphere about the origin, along which it slides. Device's
/// frame. May be called in the tick.
class SteeredHandle {
 public:
  /// The handle lags behind its target with this time constant: what comes in steps, 60 to 1000 times a second, goes
  /// out without jumps of the velocity.
  static constexpr double kSmoothing_s = 0.02;
  /// No push of a mouse moves the handle faster.
  static constexpr double kMaxSpeed_m_s = 1;
  static constexpr double kWorkspaceRadius_m = 0.15;

  /// @throws InvalidParameter unless 0 < tick_s <= 0.1 and workspace_radius_m > 0.
  explicit SteeredHandle(double tick_s, double workspace_radius_m = kWorkspaceRadius_m);

  /// Limits of a device that shows no force, in this workspace.
  [[nodiscard]] static DeviceLimits limits() noexcept;

  /// One tick at this speed. The twist that is returned is always exactly the pose's step divided by the tick.
  const Movement& drive(const Twist& speed) noexcept;

  /// One tick in which the target is shifted. Not finite: stays.
  const Movement& displace(const Vec3& by_m) noexcept;

 private:
  const Movement& follow() noexcept;

  double tick_s_, workspace_radius_m_, share_;
  Pose target_;
  Movement handle_;
};

}  // namespace haptolith
