#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "haptolith/core/vec.h"
#include "haptolith/mesh/triangle_mesh.h"
#include "haptolith/stone/stone_shape.h"

namespace haptolith {

/// A point of a solid's surface.
struct SurfacePoint {
  Vec3 point_m = Vec3::Zero();
  Vec3 inward = Vec3::Zero();  ///< unit normal
};

/// Points spread evenly over a surface, as many on each triangle as its area is worth.
[[nodiscard]] std::vector<SurfacePoint> spreadOver(const TriangleMesh& surface, std::size_t count);

/// Depth of a point in a solid, negative outside; `most_m` if it is deeper.
using DepthInSolid = std::function<double(const Vec3& point_m, double most_m)>;

struct FillingOptions {
  double size_m = 1;              ///< size of the solid: the reference for small lengths
  double near_m = 0;              ///< surface that is as near to the union is filled up to
  double filled = 0.98;           ///< part of the surface that has to be
  double largest_radius_m = 1;    ///< no sphere that fits in is larger
  std::size_t most_spheres = 60;  ///< at least 1
};

/// Fills a solid with spheres. For each surface point there is a largest sphere inside that touches it; of these comes
/// the largest of all first, then always the one that takes most from the sum of squared distances between surface and
/// union, which is what a particle feels that slides over it.
/// @returns spheres that hold together and reach nowhere out of the solid; none where none fits in.
[[nodiscard]] std::vector<StoneSphere> fillWithSpheres(const std::vector<SurfacePoint>& surface,
                                                       const DepthInSolid& depth, const FillingOptions& options);

/// Scales a stone so that its volume is that of a sphere of the diameter `size_m`.
[[nodiscard]] StoneShape scaledTo(StoneShape stone, double size_m);

}  // namespace haptolith
