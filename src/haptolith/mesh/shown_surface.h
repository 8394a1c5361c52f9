#pragma once

#include <cstddef>

#include "haptolith/mesh/mend.h"
#include "haptolith/mesh/triangle_mesh.h"

namespace haptolith {

/// A mesh as pictures show it: closed, points shared by the triangles around them. A sheet becomes two surfaces, half
/// of its thickness to either side, with walls along its edges. Where there are more than `most_triangles`, points
/// within a cell of a grid become one, in the middle of them; the grid is the finest that leaves few enough. Not for
/// the tick.
[[nodiscard]] TriangleMesh shownSurface(const MendedMesh& mended, std::size_t most_triangles);

}  // namespace haptolith
