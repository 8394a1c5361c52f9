#pragma once

#include <array>
#include <cstdint>

#include "haptolith/bed/bed_state.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// The box around a tool, as the SIMD test wants it: axes of the tool in the scene, and how far it reaches along them.
struct ToolBox {
  std::array<float, 3> origin_m;                ///< tool's origin, scene frame
  std::array<std::array<float, 3>, 3> axes;     ///< x, y and z of the tool, scene frame
  std::array<float, 3> middle_m, half_edges_m;  ///< centre and half edges of the box, along the axes, from the origin
};
[[nodiscard]] ToolBox boxAround(const ToolParameters& tool, const Pose& scene_T_tool) noexcept;

/// Which of a group's 16 particles, one bit each, have their centre within `reach_m` of the box. May be called in the
/// tick.
[[nodiscard]] std::uint32_t nearBox(const ToolBox& box, float reach_m, const Float4* group) noexcept;

}  // namespace haptolith
