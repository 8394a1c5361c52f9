#include "haptolith/tool/tool_shape.h"

#include <algorithm>
#include <cmath>

namespace haptolith {

namespace {

/// A box or a plate as its outline (seen along z) and its thickness: all that contact needs to know.
struct Outline {
  double inside_m;  ///< distance from the centre to the rim, > 0 inside, < 0 outside
  Vec3 nearest_m;   ///< the rim's or the inside's point next to the centre, at the centre's height
  Vec3 outward;     ///< from the middle over the nearest rim, horizontal
};

Outline boxOutline(const Vec3& half_m, const Vec3& centre_m) {
  Outline outline;
  const Vec3 to_rim = half_m - centre_m.cwiseAbs();
  const int axis = to_rim.x() < to_rim.y() ? 0 : 1;
  outline.inside_m = to_rim[axis];
  outline.outward = Vec3::Unit(axis) * (centre_m[axis] < 0 ? -1 : 1);
  outline.nearest_m = {std::clamp(centre_m.x(), -half_m.x(), half_m.x()),
                       std::clamp(centre_m.y(), -half_m.y(), half_m.y()), centre_m.z()};
  return outline;
}

Outline discOutline(double radius_m, const Vec3& centre_m) {
  const double from_axis = std::hypot(centre_m.x(), centre_m.y());
  Outline outline;
  outline.inside_m = radius_m - from_axis;
  outline.outward = from_axis > 0 ? Vec3(centre_m.x() / from_axis, centre_m.y() / from_axis, 0) : Vec3::UnitX();
  outline.nearest_m = outline.inside_m >= 0 ? centre_m : Vec3(radius_m * outline.outward);
  outline.nearest_m.z() = centre_m.z();
  return outline;
}

Penetration sphere(double tool_radius_m, const Vec3& centre_m, double radius_m) {
  const double distance = centre_m.norm();
  return {.depth_m = tool_radius_m + radius_m - distance,
          .outward = distance > 0 ? Vec3(centre_m / distance) : Vec3::UnitZ(),
          .side = 0};
}

/// Beside the tool: the nearest point of a rim or an edge decides, which is never in doubt there.
Penetration beside(const Outline& outline, double half_height_m, const Vec3& centre_m, double radius_m) {
  Vec3 nearest = outline.nearest_m;
  nearest.z() = std::clamp(centre_m.z(), -half_height_m, half_height_m);
  const Vec3 away = centre_m - nearest;
  const double distance = away.norm();
  const int side = centre_m.z() > half_height_m ? 1 : centre_m.z() < -half_height_m ? -1 : 0;
  // A centre on the rim to the last bits has no direction of its own.
  constexpr double kOnTheRim_m = 1e-9;
  return {.depth_m = radius_m - distance,
          .outward = distance > kOnTheRim_m ? Vec3(away / distance) : outline.outward,
          .side = side};
}

/// Over, under or inside the tool: measured from the face the particle came to.
Penetration overFace(const Outline& outline, double half_height_m, const Vec3& centre_m, double radius_m, int side) {
  const double below_other_face = -side * centre_m.z() - half_height_m;
  const bool passed_through = side != 0 && below_other_face > radius_m;
  if (side == 0 || passed_through) {
    const double under_face = half_height_m - std::abs(centre_m.z());
    if (under_face > outline.inside_m) {  // it came in over the rim and is still nearest to it
      return {.depth_m = radius_m + outline.inside_m, .outward = outline.outward, .side = 0};
    }
    side = centre_m.z() < 0 ? -1 : 1;
  }
  return {.depth_m = radius_m + half_height_m - side * centre_m.z(), .outward = Vec3(0, 0, side), .side = side};
}

}  // namespace

Penetration penetration(const ToolParameters& tool, const Vec3& centre_m, double radius_m, int side) noexcept {
  if (tool.shape == ToolShape::kSphere) {
    return sphere(tool.diameter_m / 2, centre_m, radius_m);
  }
  const bool box = tool.shape == ToolShape::kBox;
  const double half_height = box ? tool.size_m.z() / 2 : tool.thickness_m / 2;
  const Outline outline = box ? boxOutline(tool.size_m / 2, centre_m) : discOutline(tool.diameter_m / 2, centre_m);
  Penetration found = outline.inside_m < 0 ? beside(outline, half_height, centre_m, radius_m)
                                           : overFace(outline, half_height, centre_m, radius_m, side);
  if (found.depth_m < -tool.adhesion_ratio * radius_m) {
    found.side = 0;  // it has let go
  }
  return found;
}

double enclosingRadius(const ToolParameters& tool) noexcept {
  switch (tool.shape) {
    case ToolShape::kBox: return tool.size_m.norm() / 2;
    case ToolShape::kSphere: return tool.diameter_m / 2;
    case ToolShape::kPlate: return std::hypot(tool.diameter_m, tool.thickness_m) / 2;
  }
  return 0;
}

}  // namespace haptolith
