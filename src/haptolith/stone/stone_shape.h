#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/vec.h"
#include "haptolith/mesh/triangle_mesh.h"

namespace haptolith {

/// One of the spheres that a stone is made of.
struct StoneSphere {
  Vec3 centre_m = Vec3::Zero();
  double radius_m = 0;

  [[nodiscard]] bool operator==(const StoneSphere&) const = default;
};

/// No stone is made of more.
inline constexpr std::size_t kMostStoneSpheres = 500;
/// Diameter of the sphere that has a stone's volume, in m.
inline constexpr Range kStoneSize_m{1e-3, 10};

/// A rigid stone: soil, walls, tools and other stones touch the union of its spheres. The origin of its frame is the
/// centre of its mass, along its principal axes: x along the smallest moment, z along the largest, so that a stone
/// whose z is up lies flat.
struct StoneShape {
  std::vector<StoneSphere> spheres;  ///< stone's frame
  double volume_m3 = 0;              ///< volume of their union
  Vec3 inertia_m5 = Vec3::Zero();    ///< principal moments of the union's volume: those of its mass, over its density
  double reach_m = 0;                ///< radius of the sphere about the centre of mass that holds them all
  TriangleMesh shown;                ///< for pictures, stone's frame; empty: the spheres are what it looks like

  /// Radius of the sphere of its volume.
  [[nodiscard]] double radius() const noexcept;
};

/// A stone of spheres wherever they are: volume, centre and principal axes are found, exactly for one sphere, otherwise
/// to 3e-4 by sums over 128 by 128 lines through the union, exact along each. The frame of one sphere is not turned.
/// `shown`, in the same frame, goes with them. Not for the tick.
/// @throws InvalidParameter for no sphere, more than kMostStoneSpheres, a radius or place that is not finite or not
/// above 0, or spheres that do not hold together.
[[nodiscard]] StoneShape makeStoneShape(std::vector<StoneSphere> spheres, TriangleMesh shown = {});

/// A sphere of the diameter `size_m`. @throws InvalidParameter for a size outside kStoneSize_m.
[[nodiscard]] StoneShape roundStone(double size_m);

/// An angular rock, different for each seed: a sphere cut by random planes, like broken rock, somewhat
/// longer than wide and wider than high; of up to 45 spheres that fill it up to its faces, scaled to the volume of a
/// sphere of the diameter `size_m`. No sphere reaches out of the displayed surface; 95 % of that surface is within a
/// twentieth of the size of their union. Equal seed and size give equal bits. Not for the tick.
/// @throws InvalidParameter for a size outside kStoneSize_m.
[[nodiscard]] StoneShape angularRock(double size_m, std::uint64_t seed);

}  // namespace haptolith
