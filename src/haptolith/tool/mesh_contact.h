#pragma once

#include "haptolith/mesh/distance_field.h"
#include "haptolith/tool/tool_shape.h"

namespace haptolith {

/// Directions as numbers from 1 to 225, as a byte holds them: a grid of 15 x 15 on the octahedron |x| + |y| + |z| = 1,
/// unfolded (Meyer et al. 2010). A direction is at most 17 degrees from the one of its number; those along
/// the axes are exact. 0 for no direction.
[[nodiscard]] int directionCode(const Vec3& direction) noexcept;
[[nodiscard]] Vec3 directionOf(int code) noexcept;

/// penetration() of a sphere into a body that is known by its distance field alone.
///
/// A wall may be thinner than a particle is pushed in, so the nearest surface may be the wall's other side. Therefore a
/// particle keeps the direction in which it touched: when its centre is inside the body, or outside on a side that
/// looks another way, the surface is looked for from the centre along that direction, through the wall. But not when
/// what it touched is still behind it, as between two walls, of which the nearer one counts then. Contact ends when
/// there is no surface within two radii, as beyond the wall's edge, or when it lies wholly on the other side. May be
/// called in the tick.
/// @param letting_go_m  distance outside at which contact has ended.
/// @param side  what the last call for this particle returned, a directionCode() as a signed byte; 0 at first.
[[nodiscard]] Penetration meshPenetration(const DistanceField& field, const Vec3& centre_m, double radius_m,
                                          double letting_go_m, int side) noexcept;

}  // namespace haptolith
