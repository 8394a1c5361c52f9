#pragma once

#include <string_view>
#include <vector>

#include "haptolith/study/protocol/protocol_keys.h"

namespace haptolith {

/// What a block may vary: "preset", "body", "soil", the key of a slider or that of a number of the scene.
[[nodiscard]] std::vector<std::string_view> variedThings();

/// The name of one of variedThings() on an axis; empty for soils by name.
[[nodiscard]] std::string_view axisLabelOf(std::string_view varies);

/// Sets the stimuli of the draft's block, levels in the order of their values.
/// @throws InvalidParameter for the key of the block in which a stimulus stands.
void readStimuli(BlockDraft& draft);

}  // namespace haptolith
