#pragma once

#include <functional>
#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/bed/bed_state.h"

namespace haptolith {

/// Grains of a graded bed before they settle together, in whole groups of one class but for the last, coarsest first.
///
/// The finest fill the box that Grading describes, each coarser class a shell of two of its diameters around it, and
/// grains of the soil's own radius, which `coarse` are, everything else. Every class is settled by itself, in a box
/// that repeats itself, and cut out of that; who would stand in a coarser grain is left out.
/// @param settled  makes a bed of one size of grain, at rest.
/// @throws InvalidParameter when no soil is where fine grains are wanted.
[[nodiscard]] std::vector<Float4> gradedGrains(const BedParameters& bed, const std::vector<Float4>& coarse,
                                               const std::function<std::vector<Float4>(const BedParameters&)>& settled);

}  // namespace haptolith
