#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/mesh/triangle_mesh.h"

namespace haptolith {

/// Thickness of what is a sheet, in m; 0: the surface has to be closed.
inline constexpr Range kSheetThickness_m{0, 0.05};
/// Openings are closed up to this part of the largest edge of the box around the mesh, measured around the opening.
inline constexpr double kLargestHole = 0.25;
/// Loose parts up to this part of that edge are left out, while they are less than kMostLooseArea of the surface.
inline constexpr double kLoosePart = 0.01;
inline constexpr double kMostLooseArea = 0.05;
/// Points on open edges that are nearer to each other than this part of that edge are one.
inline constexpr double kStitch = 1e-5;
inline constexpr std::size_t kMostShells = 1000;

struct MendOptions {
  double sheet_thickness_m = 0;  ///< kSheetThickness_m
};

/// A mesh that can be a tool: closed, so that every point is inside or outside of it, or a sheet.
struct MendedMesh {
  TriangleMesh mesh;                 ///< if closed, each edge is passed as often in one direction as in the other
  std::vector<std::int32_t> shells;  ///< which closed part each triangle belongs to, from 0
  int shell_count = 0;
  double sheet_thickness_m = 0;     ///< thickness of a surface that stays open; 0: a closed solid
  std::vector<std::string> report;  ///< repairs, a sentence each
};

/// Makes a tool of triangles as files hold them. In this order:
///
/// 1. equal points become one; then points on open edges within kStitch;
/// 2. triangles without area (two corners are one point) and copies go; where two look in opposite directions, they
///    are a wall inside the solid and both go, unless most of the mesh is such pairs: a surface drawn from both sides;
/// 3. tiny loose parts go (kLoosePart);
/// 4. neighbours are turned to look the same way, as most of them do;
/// 5. openings up to kLargestHole are closed by a fan about their middle, and slits of any length; not with a sheet's
///    thickness: there an opening is meant;
/// 6. closed parts are turned to look outwards, so that together they are their union. A part inside another is a
///    cavity where, in the file, all of it looked the other way than all of the part around it.
///
/// Closed parts are solids: inside where the winding number is one or more. Open parts are sheets of
/// `sheet_thickness_m`, when that is above 0. Not for the tick.
/// @throws InvalidParameter for a surface that stays open without a thickness, or has but one side, or more than
/// kMostShells parts, or nothing left; for a thickness outside kSheetThickness_m; Failure when stopAsked().
[[nodiscard]] MendedMesh mend(TriangleMesh mesh, const MendOptions& options = {});

}  // namespace haptolith
