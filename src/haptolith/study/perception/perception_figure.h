#pragma once

#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/study/perception/perception.h"

namespace haptolith {

/// Draws the cues of each stimulus: for each experiment a row of panels, one for the most informative cue of each hand.
/// @param perceived  perceive() of each block. @throws as Figure.
void drawForces(const OutputFile& path, const std::vector<PerceptionBlock>& blocks,
                const std::vector<std::vector<PerceivedCue>>& perceived);

/// Draws the Weber fractions of observers with their intervals, next to those of the participants in each
/// interpretation. @throws as Figure.
void drawWeberFractions(const OutputFile& path, const std::vector<PerceptionBlock>& blocks,
                        const std::vector<std::vector<PerceivedCue>>& perceived);

}  // namespace haptolith
