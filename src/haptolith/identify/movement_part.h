#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "haptolith/identify/training/force_emulator.h"
#include "haptolith/identify/training/tool_movement.h"

namespace haptolith {

/// Part of a movement that can be made separately: it begins and ends in the air.
struct MovementPart {
  std::string name;
  std::size_t first_window = 0, windows = 0;
  ToolMovement movement;  ///< movement of this part alone, from 0 s
};

/// Divides the movement of an emulator into parts. The divisions are at the centre of each half second or longer in
/// which most soils exert no force on the tool. Each part is independent if no two share their soil, as in
/// probeMovement(), whose parts get its names.
[[nodiscard]] std::vector<MovementPart> partsOf(const ToolMovement& movement, const ForceEmulator& emulator);

/// Returns the numbers of the emulator that belong to a part.
[[nodiscard]] std::vector<Eigen::Index> numbersOf(const MovementPart& part, const ForceEmulator& emulator);

}  // namespace haptolith
