#pragma once

#include <memory>
#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/bed/stones.h"
#include "haptolith/core/vec.h"
#include "haptolith/stone/stone_shape.h"

namespace haptolith {

/// What a bed's stones are, in the order in which they are counted: the placed ones, then those at random places.
struct StonesOfBed {
  std::vector<std::shared_ptr<const StoneShape>> shapes;
  std::vector<bool> fixed;
};
[[nodiscard]] StonesOfBed stonesOf(const StonesParameters& stones);

/// Whether a grain is so deep in a stone that one of the two has to make room.
[[nodiscard]] bool isInStone(const Stones& stones, const Float4& grain, double radius_m);

/// Where they are at first, above or in soil whose surface is so high. None overlaps another; placed ones stand where
/// they were put, the larger of the others are put first.
/// @throws InvalidParameter when one is not in the box, overlaps another, or finds no place.
[[nodiscard]] std::vector<Pose> startingPlaces(const BedParameters& bed, const Stones& stones, double surface_m);

}  // namespace haptolith
