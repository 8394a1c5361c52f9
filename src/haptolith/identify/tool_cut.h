#pragma once

#include <optional>

#include "haptolith/core/movement.h"
#include "haptolith/tool/tool_surface.h"

namespace haptolith {

/// Movement of a tool through soil, as an equivalent blade.
struct ToolCut {
  double depth_m = 0;   ///< depth of its lowest point below the flat surface z = 0
  double rake_rad = 0;  ///< angle of the leading side to the horizontal ahead; pi / 2: upright, pi: flat, moving down
  Vec3 ahead = Vec3::UnitX();  ///< horizontal unit vector in the direction of motion
};

/// Returns the cut of a moving tool, site frame, from the mean normal of its leading surfaces, weighted with the swept
/// area. Empty: the tool is less than `kLeastDepth_m` deep, at rest, or moves up and out. Not for the tick.
[[nodiscard]] std::optional<ToolCut> cutOf(const ToolSurface& surface, const Pose& site_T_tool,
                                           const Vec3& velocity_m_s);
inline constexpr double kLeastDepth_m = 0.004;

}  // namespace haptolith
