#pragma once

#include "haptolith/core/error.h"
#include "haptolith/core/movement.h"
#include "haptolith/core/vec.h"

namespace haptolith {

/// Source of a joint's motion.
enum class Drive {
  kNone,    ///< there is no joint: the hand holds the tool itself
  kSpeed,   ///< a motor that holds a speed, whatever torque that takes
  kTorque,  ///< a motor that gives a torque
  kFree,    ///< the soil alone
};

/// A joint: the tool turns about an axis of its hub, which the hand holds. A wheel's axle, or an auger's shaft.
struct Joint {
  Vec3 axis = Vec3::UnitZ();    ///< unit vector, tool's frame
  Vec3 point_m = Vec3::Zero();  ///< on the axis, tool's frame
  Drive drive = Drive::kNone;
  double speed_rad_s = 0;    ///< speed relative to the hub, right-handed about the axis: held by kSpeed, else the first
  double torque_nm = 0;      ///< motor torque on the tool; kTorque
  double inertia_kg_m2 = 0;  ///< moment of inertia of the tool about the axis; kTorque, kFree

  [[nodiscard]] bool any() const noexcept { return drive != Drive::kNone; }
  [[nodiscard]] bool operator==(const Joint&) const = default;
};

/// Valid ranges.
struct JointRanges {
  static constexpr Range point_m{-1, 1};  ///< along each axis
  static constexpr Range speed_rad_s{-100, 100};
  static constexpr Range torque_nm{-1000, 1000};
  static constexpr Range inertia_kg_m2{0, 1000, Ends::kOpenBelow};
};

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const Joint& joint);

/// Pose of a tool that its joint has turned from `scene_T_hub` by an angle. May be called in the tick.
[[nodiscard]] Pose turned(const Pose& scene_T_hub, const Joint& joint, double angle_rad) noexcept;

/// Twist of that tool at its origin, scene frame. May be called in the tick.
[[nodiscard]] Twist turning(const Pose& scene_T_hub, const Twist& hub, const Joint& joint, double speed_rad_s,
                            const Pose& scene_T_tool) noexcept;

/// Torque about the joint's axis in N m of a wrench about the tool's origin. May be called in the tick.
[[nodiscard]] double torqueAboutAxis(const Pose& scene_T_hub, const Joint& joint, const Pose& scene_T_tool,
                                     const Wrench& on_tool) noexcept;

/// Turns a joint in a substep: angle += speed dt. May be called in the tick.
void turn(JointState& state, double dt_s) noexcept;

/// Drives a joint in a substep, after the soil has met the tool: I d(speed)/dt = motor's torque + soil's, at
/// most as fast as JointRanges::speed_rad_s. Returns the motor's torque in N m. May be called in the tick.
double drive(const Joint& joint, JointState& state, double soil_torque_nm, double dt_s) noexcept;

}  // namespace haptolith
