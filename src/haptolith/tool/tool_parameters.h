#pragma once

#include "haptolith/core/vec.h"

namespace haptolith {

enum class ToolShape {
  kBox,     ///< `size_m`: the shovel; its largest faces look along the tool's z
  kSphere,  ///< `diameter_m`
  kPlate,   ///< a round plate, `diameter_m` across and `thickness_m` high, its axis along the tool's z
};

/// The tool and its contact with macroparticles (paper 21). The tool's origin is its centre.
struct ToolParameters {
  ToolShape shape = ToolShape::kBox;
  Vec3 size_m{0.05, 0.04, 0.005};  ///< kBox: edges along the tool's x, y, z
  double diameter_m = 0.06;        ///< kSphere, kPlate
  double thickness_m = 0.005;      ///< kPlate
  double stiffness_n_m = 500;      ///< k_tool
  double damping_factor = 1.4;     ///< c_tool = damping_factor * dt * k_tool / 2
  double adhesion_ratio = 0.002;   ///< adhesion reaches this many radii outside the tool (paper 21)

  // With soil whose friction is pairwise, these two replace the adhesion of (paper 21).
  double friction = 0.36;  ///< soil-tool friction, tan(delta); 20 degrees for polished steel
  double adhesion_n = 0;   ///< largest pull of a contact, and what it adds to the normal force
};

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const ToolParameters& tool);

}  // namespace haptolith
