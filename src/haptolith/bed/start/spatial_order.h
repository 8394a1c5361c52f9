#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "haptolith/bed/bed_state.h"
#include "haptolith/core/vec.h"

namespace haptolith {

/// Sorts points, centres of spheres of `radius_m`, by cells of about 16 each, the cells row by row and layer by layer:
/// a group of 16 particles is then a lump and not a line, so that a small place is few groups, and neighbours are met
/// in the order in which they lie in memory. (Along a Hilbert curve they are closer together, and a large bed is a
/// fifth slower: the processor does not see which neighbour comes next.)
[[nodiscard]] std::vector<Vec3> inSpatialOrder(const std::vector<Vec3>& points_m, double radius_m);

/// Returns that order as indices: which point comes first, which next.
[[nodiscard]] std::vector<std::size_t> spatialOrder(const std::vector<Vec3>& points_m, double radius_m);

/// The groups of 16 of spheres in such an order, slab by slab across the box, each a row of cells deep in y and in
/// ascending order within: threads that take a part of them each meet each other's soil along a wall, and not along a
/// whole layer, and what one has written and the other has to fetch is the dearest of all.
[[nodiscard]] std::vector<std::uint32_t> groupsInSlabs(const std::vector<Float4>& spheres, double radius_m);

}  // namespace haptolith
