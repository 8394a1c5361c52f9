#pragma once

#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/study/perception/perception.h"

namespace haptolith {

/// What a hand feels of each stimulus: for each experiment a row of panels, one for the most telling cue of each hand.
/// @param perceived  perceive() of each block. @throws as Figure.
void drawForces(const OutputFile& path, const std::vector<PerceptionBlock>& blocks,
                const std::vector<std::vector<PerceivedCue>>& perceived);

/// The Weber fractions of observers with their intervals, beside the participants' by each reading. @throws as Figure.
void drawWeberFractions(const OutputFile& path, const std::vector<PerceptionBlock>& blocks,
                        const std::vector<std::vector<PerceivedCue>>& perceived);

}  // namespace haptolith
