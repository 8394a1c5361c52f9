#pragma once

#include <string>
#include <vector>

#include "haptolith/figure/figure.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/scene_file/scene_file.h"

namespace haptolith {

/// Data for a figure of a run.
struct RunHistory {
  std::vector<TickRecord> records;  ///< evenly thinned if there are too many
  SceneSnapshot strongest;          ///< scene of the max. force among the sampled moments
};

constexpr int kRunFigureWidth_px = 1200;
constexpr int kRunFigureHeight_px = 900;

/// Draws the scene at the max. force, force over time, force over the tool's height, and the durations of ticks; then
/// saves. @throws as Figure.
void drawRun(Figure& figure, const SceneFile& scene_file, const RunHistory& history, const LoopStatistics& statistics);

}  // namespace haptolith
