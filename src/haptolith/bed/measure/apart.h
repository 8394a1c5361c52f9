#pragma once

#include <cmath>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/core/vec.h"

namespace haptolith {

/// Returns the vector from the second centre to the first in m, the shorter way across periodic sides.
[[nodiscard]] inline Vec3 apart(const BedParameters& bed, const Float4& first, const Float4& second) {
  Vec3 apart_m = Vec3(first.x, first.y, first.z) - Vec3(second.x, second.y, second.z);
  apart_m.x() -= bed.periodic_x ? bed.width_m * std::round(apart_m.x() / bed.width_m) : 0;
  apart_m.y() -= bed.periodic_y ? bed.length_m * std::round(apart_m.y() / bed.length_m) : 0;
  return apart_m;
}

}  // namespace haptolith
