#pragma once

#include <vector>

#include "haptolith/core/vec.h"

namespace haptolith {

/// The same points in the order of a Hilbert curve through cells of `cell_m` (Skilling, AIP Conf. Proc. 707 (2004)
/// 381): who is near in the list is near in space, so that a group of 16 particles is a lump and not a line, neighbours
/// share cache lines, and a small place is few groups.
[[nodiscard]] std::vector<Vec3> inSpatialOrder(const std::vector<Vec3>& points_m, double cell_m);

}  // namespace haptolith
