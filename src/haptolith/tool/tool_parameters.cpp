#include "haptolith/tool/tool_parameters.h"

#include "haptolith/core/error.h"

namespace haptolith {

void validate(const ToolParameters& tool) {
  constexpr Range kLength{1e-5, 10};
  for (int axis = 0; axis < 3; ++axis) {
    requireInRange("size_m", tool.size_m[axis], kLength);
  }
  requireInRange("diameter_m", tool.diameter_m, kLength);
  requireInRange("thickness_m", tool.thickness_m, kLength);
  requireInRange("opening_m", tool.opening_m, kLength);
  requireInRange("length_m", tool.length_m, kLength);
  requireInRange("cone_angle_rad", tool.cone_angle_rad, {0.1, 3});
  requireInRange("stiffness_n_m", tool.stiffness_n_m, {0, 1e7});
  requireInRange("damping_factor", tool.damping_factor, {0, 10});
  requireInRange("adhesion_ratio", tool.adhesion_ratio, {0, 1});
  requireInRange("friction", tool.friction, {0, 10});
  requireInRange("adhesion_n", tool.adhesion_n, {0, 1e6});
}

}  // namespace haptolith
