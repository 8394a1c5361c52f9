#pragma once

#include <string>
#include <vector>

#include "haptolith/figure/figure.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/scene_file/scene_file.h"

namespace haptolith {

/// What a figure of a run is drawn from.
struct RunHistory {
  std::vector<TickRecord> records;  ///< thinned out evenly once there are too many to see
  SceneSnapshot strongest;          ///< the scene when the hand felt most, of the moments looked at
};

constexpr int kRunFigureWidth_px = 1200;
constexpr int kRunFigureHeight_px = 900;

/// Draws the scene at its strongest moment, force over time, force over the tool's height, and how long ticks took;
/// then saves. @throws as Figure.
void drawRun(Figure& figure, const SceneFile& scene_file, const RunHistory& history, const LoopStatistics& statistics);

}  // namespace haptolith
