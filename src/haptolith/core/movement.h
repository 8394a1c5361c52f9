#pragma once

#include "haptolith/core/vec.h"

namespace haptolith {

/// Pose and twist of a body's origin, both in one frame, which the name or the doc gives.
struct Movement {
  Pose pose;
  Twist twist;
};

/// Movement of the tool in a hand, scene frame, and how far the hand holds the jaws open.
struct HandState : Movement {
  double opening = 1;  ///< 0 closed to 1 wide open
};

/// Wrench on a tool about its origin, scene frame, and the force between its jaws.
struct ToolForce {
  Wrench wrench;
  double grip_n = 0;  ///< > 0 opens the fingers
};

/// A joint between two ticks. Torques act on the tool about the axis and are means over the last tick.
struct JointState {
  double angle_rad = 0;  ///< -pi to pi; at 0 the tool's frame is the hub's
  double speed_rad_s = 0;
  double soil_torque_nm = 0;
  double motor_torque_nm = 0;  ///< holds a speed against the soil: minus the soil's
};

/// The rotation from one orientation to another as a vector: axis times angle, in rad, scene frame.
[[nodiscard]] Vec3 rotationBetween(const Quat& from, const Quat& to) noexcept;

/// An orientation, turned on by a rotation vector: the other way round of rotationBetween().
[[nodiscard]] Quat turnedBy(const Vec3& rotation, const Quat& orientation) noexcept;

/// Movement from one pose to another within a tick, at the second pose.
[[nodiscard]] Movement movement(const Pose& from, const Pose& to, double tick_s) noexcept;

/// The vector, shortened to `largest` where it is longer.
[[nodiscard]] Vec3 atMost(double largest, const Vec3& v) noexcept;

}  // namespace haptolith
