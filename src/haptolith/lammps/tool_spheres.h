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

/// Joint contact of spheres with a particle that is pressed into the tool's face.
struct SpheresUnderAGrain {
  double count = 1;      ///< number of touched spheres
  double depth_m = 0;    ///< sum of its depths in them
  double pressed_m = 0;  ///< depth in the face itself
};

/// In the middle of some hundred grains on the tool, pressed in by a twentieth of their radius. Each sphere is to be
/// softer than the tool by pressed_m / depth_m. Deeper grains touch more spheres: together they are a spring whose
/// force goes with the square of the depth, right at a twentieth of the radius.
[[nodiscard]] SpheresUnderAGrain spheresUnderAGrain(const ToolSpheres& spheres, const ToolParameters& tool,
                                                    double grain_radius_m);

}  // namespace haptolith
