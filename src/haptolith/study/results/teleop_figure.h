#pragma once

#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/results/teleop_results.h"

namespace haptolith {

/// Draws a panel for each measure of the robot's task, over the blocks: the mean of each participant, joined from block
/// to block, and the mean over participants with its interval. @param results  results of this protocol, not empty.
/// @throws as Figure.
void drawTeleopFigure(const OutputFile& path, const StudyProtocol& protocol,
                      const std::vector<TeleopBlockResult>& results, double confidence, std::string_view title);

}  // namespace haptolith
