#pragma once

#include <cstdint>
#include <vector>

#include "haptolith/core/vec.h"
#include "haptolith/identify/training/soil_sample.h"
#include "haptolith/identify/training/tool_movement.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// Where a movement is carried out.
struct DiggingField {
  double width_m = 0.28, length_m = 0.28, depth_m = 0.07;
  double gravity_m_s2 = 1.625;
  std::uint64_t seed = 1;  ///< of the specimen
};

/// Length of the windows over which forces are averaged: grains do not strike alike in two specimens of one soil.
inline constexpr double kForceWindow_s = 0.25;

/// What the soil did to the tool: the mean force in each window, site frame; one that is not full is left out.
using WindowForces = std::vector<Vec3>;

/// Carries a movement out in soil that nothing has touched. Not for the tick.
/// @throws InvalidParameter as Scene; Failure when the bed is no longer sound, or `progress` gave up.
[[nodiscard]] WindowForces digAlong(const ToolMovement& movement, const ToolParameters& tool, const SoilSample& sample,
                                    const DiggingField& field, const LabProgress& progress = {});

}  // namespace haptolith
