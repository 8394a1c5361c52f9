#pragma once

#include <vector>

#include "haptolith/core/vec.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// A tool as spheres of one size just under its surface, for engines that know nothing else.
struct ToolSpheres {
  std::vector<Vec3> centres_tool_m;  ///< tool's frame
  double radius_m = 0;
};

/// Spheres that touch the tool's surface from inside, no further apart than they are large: a grain that slides over
/// them goes up and down by a hundredth of their size. Where the tool is thinner than a sphere is, they are smaller.
/// Not for the tick.
/// @param most_radius_m  of the spheres; a third of a grain's is fine enough to feel smooth.
/// @param opening_m  between jaws.
/// @throws InvalidParameter for a tool that would need more than a million.
[[nodiscard]] ToolSpheres toolSpheres(const ToolParameters& tool, double opening_m, double most_radius_m);

}  // namespace haptolith
