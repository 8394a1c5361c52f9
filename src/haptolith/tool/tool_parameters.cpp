#include "haptolith/tool/tool_parameters.h"

#include "haptolith/core/error.h"

namespace haptolith {

void validate(const ToolParameters& tool) {
  for (int axis = 0; axis < 3; ++axis) {
    requireInRange("size_m", tool.size_m[axis], ToolRanges::length_m);
  }
  requireInRange("diameter_m", tool.diameter_m, ToolRanges::length_m);
  requireInRange("thickness_m", tool.thickness_m, ToolRanges::length_m);
  requireInRange("opening_m", tool.opening_m, ToolRanges::length_m);
  requireInRange("length_m", tool.length_m, ToolRanges::length_m);
  requireInRange("cone_angle_rad", tool.cone_angle_rad, ToolRanges::cone_angle_rad);
  requireInRange("jaw_bend_rad", tool.jaw_bend_rad, ToolRanges::jaw_bend_rad);
  if (tool.shape == ToolShape::kMesh && tool.mesh == nullptr) {
    throw InvalidParameter("shape", "mesh without a mesh", "another shape, or mesh with a mesh");
  }
  requireInRange("stiffness_n_m", tool.stiffness_n_m, ToolRanges::stiffness_n_m);
  requireInRange("damping_factor", tool.damping_factor, ToolRanges::damping_factor);
  requireInRange("adhesion_ratio", tool.adhesion_ratio, ToolRanges::adhesion_ratio);
  requireInRange("friction", tool.friction, ToolRanges::friction);
  requireInRange("adhesion_n", tool.adhesion_n, ToolRanges::adhesion_n);
  requireInRange("mass_kg", tool.mass_kg, ToolRanges::mass_kg);
  for (int axis = 0; axis < 3; ++axis) {
    requireInRange("centre_of_mass_m", tool.centre_of_mass_m[axis], ToolRanges::centre_of_mass_m);
  }
  validate(tool.joint);
}

Wrench weightOf(const ToolParameters& tool, const Quat& orientation, const Vec3& gravity_m_s2) noexcept {
  const Vec3 force_n = tool.mass_kg * gravity_m_s2;
  return {force_n, (orientation * tool.centre_of_mass_m).cross(force_n)};
}

}  // namespace haptolith
