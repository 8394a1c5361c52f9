#pragma once

#include "haptolith/bed/bed.h"

namespace haptolith {

/// Mean height of the soil as a camera above it would see it, over the floor, in m: of spheres over a grid as fine as
/// half a grain, a grain's width away from the sides. Soil of other grains lies as high by it where it was filled as
/// high, which its highest grain does not. Not for the tick.
[[nodiscard]] double meanSurfaceHeight(const Bed& bed);

}  // namespace haptolith
