#pragma once

#include <string>

#include "haptolith/bed/bed_state.h"

namespace haptolith {

/// Returns the first invariant of the step that a state breaks, in one sentence; empty if it keeps all. Checked: finite
/// positions and velocities; ghosts behind the particles and in the lists; contact lists that are symmetric, name each
/// neighbour once and count their rows; slips that are opposite from both sides of a contact between groups that are
/// both awake; sleeping groups that stand still. Takes as long as some steps; not for the tick.
[[nodiscard]] std::string inconsistency(const BedState& state);

}  // namespace haptolith
