#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "haptolith/core/error.h"

namespace haptolith {

/// Three coordinates in the frame that the name or the doc gives. In the scene frame x and y are horizontal, z is up.
using Vec3 = Eigen::Vector3d;
using Quat = Eigen::Quaterniond;

/// Valid norms of an orientation from outside: an empty message gives 0, and no device or page rounds so
/// coarsely.
inline constexpr Range kUnitNorm{0.99, 1.01};
[[nodiscard]] inline bool isUnit(const Quat& orientation) noexcept {
  const double norm = orientation.norm();  // NaN is outside
  return norm >= kUnitNorm.lowest && norm <= kUnitNorm.highest;
}

/// Position (m) and orientation of a body's frame in another frame. Variables are named frame_T_body: scene_T_tool is
/// the tool's pose in the scene frame, device_T_handle the handle's in the device frame.
struct Pose {
  Vec3 position_m = Vec3::Zero();
  Quat orientation = Quat::Identity();

  /// A point of the body's frame, in the frame that the pose is in.
  [[nodiscard]] Vec3 fromBody(const Vec3& point_body) const { return position_m + orientation * point_body; }
  /// The inverse of fromBody().
  [[nodiscard]] Vec3 toBody(const Vec3& point) const { return orientation.conjugate() * (point - position_m); }
};

/// Linear (m/s) and angular (rad/s) velocity of a body's origin, in the axes of the frame that its pose is in.
struct Twist {
  Vec3 linear_m_s = Vec3::Zero();
  Vec3 angular_rad_s = Vec3::Zero();

  /// Velocity of the body's point at `lever_m` from its origin, in m/s.
  [[nodiscard]] Vec3 at(const Vec3& lever_m) const { return linear_m_s + angular_rad_s.cross(lever_m); }
};

/// Force (N) and torque (N m) about a body's origin, in the axes of the frame that the name or the doc gives: scene
/// frame for soil wrenches, device frame for device wrenches.
struct Wrench {
  Vec3 force_n = Vec3::Zero();
  Vec3 torque_nm = Vec3::Zero();

  [[nodiscard]] bool isZero() const { return force_n.isZero(0) && torque_nm.isZero(0); }

  void add(const Wrench& other) {
    force_n += other.force_n;
    torque_nm += other.torque_nm;
  }
  void add(const Vec3& force, const Vec3& lever_m) {
    force_n += force;
    torque_nm += lever_m.cross(force);
  }
};

}  // namespace haptolith
