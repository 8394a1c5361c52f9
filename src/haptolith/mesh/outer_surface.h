#pragma once

#include "haptolith/mesh/mend.h"
#include "haptolith/mesh/triangle_tree.h"

namespace haptolith {

/// The surface of the union of a solid's closed parts, as loose triangles: what lies inside another part is left out.
/// Triangles that pass into another part are cut in halves down to `finest_m`, and each piece stays or goes as its
/// middle does: the surface ends that near to where parts meet. Not for the tick.
/// @param tree  of `solid.mesh`.
[[nodiscard]] TriangleMesh outerSurface(const MendedMesh& solid, const TriangleTree& tree, double finest_m,
                                        int threads);

/// Thickness of the thinnest walls of a solid, in m; infinite without walls. Rays go inwards from points spread evenly
/// over the surface; where they leave it again through a face that is parallel within 10 degrees, there is a wall (not
/// at the edge of a blade). Walls of less than 1 % of the surface do not count. Not for the tick.
/// @param tree  of `solid.mesh`.
[[nodiscard]] double thinnestWall(const MendedMesh& solid, const TriangleTree& tree, int threads);

}  // namespace haptolith
