#pragma once

#include <cstdint>
#include <optional>

#include "haptolith/core/vec.h"
#include "haptolith/device/hand/hand_parameters.h"

namespace haptolith {

/// What a person at a mouse, a touch screen or a controller commands a virtual hand to do. Only the newest counts.
struct HandCommand {
  std::optional<Pose> held = std::nullopt;  ///< where the tool is pulled to, scene frame; none: `manoeuvre` goes on
  Manoeuvre manoeuvre = Manoeuvre::kScoop;  ///< kPoses: the file it was made with
  double surface_m = 0;                     ///< height of the soil's surface
  std::uint32_t beginnings = 0;             ///< grows when the manoeuvre is to begin again
};

}  // namespace haptolith
