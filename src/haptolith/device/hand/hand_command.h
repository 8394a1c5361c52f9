#pragma once

#include <cstdint>
#include <optional>

#include "haptolith/core/vec.h"
#include "haptolith/device/hand/hand_parameters.h"

namespace haptolith {

/// Command to a virtual hand from a mouse, a touch screen or a controller. Only the newest counts.
struct HandCommand {
  std::optional<Pose> held = std::nullopt;  ///< target of the tool, scene frame; empty: `motion` continues
  HandMotion motion = HandMotion::kScoop;   ///< kPoses: the file it was made with
  double surface_m = 0;                     ///< height of the soil's surface
  std::uint32_t beginnings = 0;             ///< grows when the motion is to begin again
};

}  // namespace haptolith
