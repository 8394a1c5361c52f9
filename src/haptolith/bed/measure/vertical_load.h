#pragma once

#include "haptolith/bed/bed.h"

namespace haptolith {

/// Load of the soil above a level on the soil below it.
struct VerticalLoad {
  double carried_n = 0;  ///< vertical force of contacts between particles across the level
  double weight_n = 0;   ///< weight of the particles whose centres are above it
};

/// Load at a height, of soil with contact friction and particles of one size that is at rest, gravity along -z: the
/// geostatic stress rho g z times the area is its weight. The difference hangs on the walls, or moves. Not for the
/// tick.
[[nodiscard]] VerticalLoad verticalLoad(const Bed& bed, double height_m);

}  // namespace haptolith
