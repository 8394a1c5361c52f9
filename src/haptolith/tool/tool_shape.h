#pragma once

#include <array>
#include <cstdint>

#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Overlap of a particle with a tool: depth of its sphere, and the way out.
struct Penetration {
  double depth_m = 0;            ///< z of (paper 21): > 0 overlapping, < 0 the gap between the surfaces
  Vec3 outward = Vec3::UnitZ();  ///< unit normal from the tool to the particle, tool frame
  int side = 0;  ///< large face that the particle touches: +1, -1, or 0 (next to the tool, or a sphere);
                 ///< with a mesh, a direction: see meshPenetration()
};

/// Penetration of a sphere of `radius_m` at `centre_m` (tool frame) into the tool. May be called in the tick.
///
/// A box and a plate are thinner than a particle, so "the nearest face" would flip to the far side as soon as a
/// particle is pushed in by half the thickness, and shoot it through. Therefore a particle keeps the large face it came
/// to: as long as its centre is over that face it is measured from there, until it has left the face's outline, has let
/// go of it, or lies wholly on the other side.
/// Jaws are two tools in one: see jawContacts(). For a mesh, `side` is a direction: see meshPenetration().
/// @param side  what the last call for this particle returned; 0 at first.
[[nodiscard]] Penetration penetration(const ToolParameters& tool, const Vec3& centre_m, double radius_m,
                                      int side) noexcept;

/// Contact of a particle with one of two jaws.
struct JawContact {
  Penetration found;
  double share = 1;  ///< fraction of the contact's force that counts
};
struct JawContacts {
  std::array<JawContact, 2> jaws;  ///< left, at x < 0, and right
  std::int8_t sides = 0;           ///< both jaws' Penetration::side, for the next call
};

/// Penetration of a sphere into both of the jaws, `tool.opening_m` apart. Each jaw is a box (see penetration()), bent
/// to a shell by `jaw_bend_rad` (JawShell), and a particle between the two touches both. Where they make up
/// one surface, as closed jaws do, it must not be pushed twice: of two contacts with depths d1 >= d2 and normals that
/// agree, the force is shared so that together they push
///
///     k d1                            jaws that touch: the other jaw counts for nothing
///     k (d1 - d2 / 2) and k d2 / 2    under a narrow slot: the two edges carry the particle together
///
/// and steadily between these, by the part of the way from point to point that is slot, and between these and two
/// contacts of full strength, by the angle between the normals: from 60 to 90 degrees. May be called in the tick.
/// @param sides  what the last call for this particle returned; 0 at first.
[[nodiscard]] JawContacts jawContacts(const ToolParameters& tool, const Vec3& centre_m, double radius_m,
                                      std::int8_t sides) noexcept;

/// Radius of the sphere around the tool's origin that holds all of it, in m.
[[nodiscard]] double enclosingRadius(const ToolParameters& tool) noexcept;

/// Lowest and highest corner of the box around the tool, tool frame, in m; of jaws, as far open as they are.
struct ToolCorners {
  Vec3 low_m, high_m;
};
[[nodiscard]] ToolCorners cornersOf(const ToolParameters& tool) noexcept;

}  // namespace haptolith
