#pragma once

#include <memory>
#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/bed/stones.h"
#include "haptolith/core/vec.h"
#include "haptolith/stone/stone_shape.h"

namespace haptolith {

/// The stones of a bed, in the order of their indices: the placed ones, then those at random places.
struct StonesOfBed {
  std::vector<std::shared_ptr<const StoneShape>> shapes;
  std::vector<bool> fixed;
};
[[nodiscard]] StonesOfBed stonesOf(const StonesParameters& stones);

/// Whether a grain is so deep in a stone that one of the two has to make room.
[[nodiscard]] bool isInStone(const Stones& stones, const Float4& grain, double radius_m);

/// Initial poses, above or in soil with this surface height. No stone overlaps another; placed ones keep their
/// place, the larger of the others are put first.
/// @throws InvalidParameter when one is not in the box, overlaps another, or finds no place.
[[nodiscard]] std::vector<Pose> startingPlaces(const BedParameters& bed, const Stones& stones, double surface_m);

}  // namespace haptolith
