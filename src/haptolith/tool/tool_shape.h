#pragma once

#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Where a particle's centre stands against a tool: how deep its sphere reaches in, and which way is out.
struct Penetration {
  double depth_m = 0;            ///< z of (paper 21): > 0 overlapping, < 0 the gap between the surfaces
  Vec3 outward = Vec3::UnitZ();  ///< unit normal from the tool to the particle, tool frame
  int side = 0;                  ///< large face the particle lies on: +1, -1, or 0 (beside the tool, or a sphere)
};

/// Penetration of a sphere of `radius_m` at `centre_m` (tool frame) into the tool. May be called in the tick.
///
/// A box and a plate are thinner than a particle, so "the nearest face" would flip to the far side as soon as a
/// particle is pushed in by half the thickness, and shoot it through. Therefore a particle keeps the large face it came
/// to: as long as its centre is over that face it is measured from there, until it has left the face's outline, has let
/// go of it, or lies wholly on the other side.
/// @param side  what the last call for this particle returned; 0 at first.
[[nodiscard]] Penetration penetration(const ToolParameters& tool, const Vec3& centre_m, double radius_m,
                                      int side) noexcept;

/// Radius of the sphere around the tool's origin that holds all of it, in m.
[[nodiscard]] double enclosingRadius(const ToolParameters& tool) noexcept;

}  // namespace haptolith
