#pragma once

#include <cstddef>
#include <vector>

#include "haptolith/core/vec.h"

namespace haptolith {

/// The same points, of spheres of `radius_m`, in cells of about 16 each, the cells row by row and layer by layer: a
/// group of 16 particles is then a lump and not a line, so that a small place is few groups, and neighbours are met in
/// the order in which they lie in memory. (Along a Hilbert curve they are closer together, and a large bed is a fifth
/// slower: the processor does not see which neighbour comes next.)
[[nodiscard]] std::vector<Vec3> inSpatialOrder(const std::vector<Vec3>& points_m, double radius_m);

/// The same as an order: which point comes first, which next.
[[nodiscard]] std::vector<std::size_t> spatialOrder(const std::vector<Vec3>& points_m, double radius_m);

}  // namespace haptolith
