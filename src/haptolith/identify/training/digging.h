#pragma once

#include <cstdint>
#include <vector>

#include "haptolith/core/vec.h"
#include "haptolith/identify/training/soil_sample.h"
#include "haptolith/identify/training/tool_movement.h"
#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// Conditions of a simulated movement.
struct DiggingField {
  double width_m = 0.28, length_m = 0.28, depth_m = 0.07;
  double gravity_m_s2 = 1.625;
  std::uint64_t seed = 1;  ///< seed of the specimen
};

/// Length of the windows over which forces are averaged, because single impacts differ between specimens of one soil.
inline constexpr double kForceWindow_s = 0.25;

/// Mean force of the soil on the tool in each window, site frame; an incomplete window is left out.
using WindowForces = std::vector<Vec3>;

/// Simulates a movement in undisturbed soil. Not for the tick.
/// @throws InvalidParameter as Scene; Failure when the bed has failed, or `progress` cancelled.
[[nodiscard]] WindowForces digAlong(const ToolMovement& movement, const ToolParameters& tool, const SoilSample& sample,
                                    const DiggingField& field, const LabProgress& progress = {});

}  // namespace haptolith
