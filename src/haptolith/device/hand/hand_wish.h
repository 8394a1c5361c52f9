#pragma once

#include <cstdint>
#include <optional>

#include "haptolith/core/vec.h"
#include "haptolith/device/hand/hand_parameters.h"

namespace haptolith {

/// What somebody at a mouse, a touch screen or a controller wants of a virtual hand. The newest wish is the one that
/// counts.
struct HandWish {
  std::optional<Pose> held = std::nullopt;  ///< where the tool is pulled to, scene frame; none: `manoeuvre` goes on
  Manoeuvre manoeuvre = Manoeuvre::kScoop;  ///< kPoses: the file it was made with
  double surface_m = 0;                     ///< height of the soil's surface
  std::uint32_t beginnings = 0;             ///< grows when the manoeuvre shall begin anew
};

}  // namespace haptolith
