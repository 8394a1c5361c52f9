#pragma once

#include <string_view>
#include <vector>

#include "haptolith/study/protocol/protocol_keys.h"

namespace haptolith {

/// Returns the quantities that a block may vary: "preset", "body", "soil", keys of sliders, and keys of scene numbers.
[[nodiscard]] std::vector<std::string_view> variedThings();

/// Returns the axis label of one of variedThings(); empty for soils by name.
[[nodiscard]] std::string_view axisLabelOf(std::string_view varies);

/// Sets the stimuli of the draft's block, with levels in the order of their values.
/// @throws InvalidParameter with the key that contains an invalid stimulus.
void readStimuli(BlockDraft& draft);

}  // namespace haptolith
