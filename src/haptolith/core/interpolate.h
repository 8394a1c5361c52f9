#pragma once

#include "haptolith/core/assert.h"
#include "haptolith/core/turn.h"
#include "haptolith/core/vec.h"

namespace haptolith {

/// The pose a share (0 to 1) of the way from one to the other; exactly `to` at 1. May be called in the tick.
[[nodiscard]] inline Pose interpolate(const Pose& from, const Pose& to, double share) noexcept {
  HAPTO_ASSERT(share >= 0 && share <= 1);
  if (share == 1) {
    return to;
  }
  return {from.position_m + share * (to.position_m - from.position_m), slerp(from.orientation, to.orientation, share)};
}

}  // namespace haptolith
