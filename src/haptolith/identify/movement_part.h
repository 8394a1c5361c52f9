#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "haptolith/identify/training/force_emulator.h"
#include "haptolith/identify/training/tool_movement.h"

namespace haptolith {

/// A stretch of a movement that can be made by itself: it begins and ends in the air.
struct MovementPart {
  std::string name;
  std::size_t first_window = 0, windows = 0;
  ToolMovement movement;  ///< of this part alone, from 0 s on
};

/// The parts of the movement that an emulator has learned, which together are the movement. They are parted in the
/// middle of each half second and more in which most soils do nothing to the tool. Each can be told alone where no two
/// share their soil, as in probeMovement(), whose parts have its names.
[[nodiscard]] std::vector<MovementPart> partsOf(const ToolMovement& movement, const ForceEmulator& emulator);

/// Those numbers of the emulator that belong to a part.
[[nodiscard]] std::vector<Eigen::Index> numbersOf(const MovementPart& part, const ForceEmulator& emulator);

}  // namespace haptolith
