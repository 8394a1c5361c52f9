#pragma once

#include "haptolith/core/vec.h"

namespace haptolith {

// Rotations, with the same bits on every machine (portable_math.h). All may be called in the tick.

/// Rotation by an angle about a unit axis.
[[nodiscard]] Quat turnAbout(const Vec3& axis, double angle_rad) noexcept;

/// Rotation about x, then about y, then about z, each an axis of the outer frame.
[[nodiscard]] Quat turnAboutXyz(const Vec3& angles_rad) noexcept;

/// Axis times angle (0 to pi) of a unit quaternion, rad.
[[nodiscard]] Vec3 rotationVector(const Quat& turn) noexcept;

/// The orientation a share (0 to 1) of the shortest way from one to another (Shoemake 1985).
[[nodiscard]] Quat slerp(const Quat& from, const Quat& to, double share) noexcept;

}  // namespace haptolith
