#pragma once

#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/results/teleop_results.h"

namespace haptolith {

/// A panel for each measure of work for a robot, over the blocks: every person's mean, joined from block to block, and
/// the mean over people with its interval. @param results  some, of this protocol. @throws as Figure.
void drawTeleopFigure(const OutputFile& path, const StudyProtocol& protocol,
                      const std::vector<TeleopBlockResult>& results, double confidence, std::string_view title);

}  // namespace haptolith
