#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "haptolith/core/vec.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// A tool's surface as triangles, counter-clockwise seen from outside.
struct ToolSurface {
  std::vector<Vec3> points_tool_m;  ///< tool's frame
  std::vector<std::array<std::int32_t, 3>> triangles;
};

/// Shape of a tool for pictures; round ones have corners on their true surface. Equal numbers of points and triangles
/// for every opening. Not for the tick.
/// @param opening_m  between jaws, >= 0; of no meaning to another tool.
[[nodiscard]] ToolSurface toolSurface(const ToolParameters& tool, double opening_m);

}  // namespace haptolith
