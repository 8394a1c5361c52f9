#pragma once

#include <optional>

#include "haptolith/core/movement.h"
#include "haptolith/tool/tool_surface.h"

namespace haptolith {

/// How a tool goes through soil, as a blade would.
struct ToolCut {
  double depth_m = 0;   ///< of its lowest point below the flat surface z = 0
  double rake_rad = 0;  ///< of what leads over the horizontal ahead: pi / 2 is upright, pi lies flat and goes down
  Vec3 ahead = Vec3::UnitX();  ///< horizontal unit vector, the way it goes
};

/// The cut of a tool that goes somewhere, site frame: the mean of the normals of all that leads, each as large as the
/// area that it sweeps. None: the tool is less than `kLeastDepth_m` deep, stands still, or goes up and out.
/// Not for the tick.
[[nodiscard]] std::optional<ToolCut> cutOf(const ToolSurface& surface, const Pose& site_T_tool,
                                           const Vec3& velocity_m_s);
inline constexpr double kLeastDepth_m = 0.004;

}  // namespace haptolith
