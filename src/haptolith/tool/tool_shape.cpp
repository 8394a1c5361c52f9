#include "haptolith/tool/tool_shape.h"

#include <algorithm>
#include <cmath>

#include "haptolith/core/assert.h"
#include "haptolith/core/math/portable_math.h"
#include "haptolith/tool/jaw_shell.h"
#include "haptolith/tool/mesh_contact.h"
#include "haptolith/tool/tool_mesh.h"

namespace haptolith {

namespace {

/// A box or a plate as its outline (seen along z) and its thickness: all that contact needs to know.
struct Outline {
  double inside_m;  ///< distance from the centre to the rim, > 0 inside, < 0 outside
  Vec3 nearest_m;   ///< the rim's or the inside's point next to the centre, at the centre's height
  Vec3 outward;     ///< from the middle over the nearest rim, horizontal
};

Outline boxOutline(const Vec3& half_m, const Vec3& centre_m) {
  HAPTO_ASSERT((half_m.array() > 0).all());
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
  HAPTO_ASSERT(radius_m >= 0);
  const double from_axis = portable::hypot(centre_m.x(), centre_m.y());
  Outline outline;
  outline.inside_m = radius_m - from_axis;
  outline.outward = from_axis > 0 ? Vec3(centre_m.x() / from_axis, centre_m.y() / from_axis, 0) : Vec3::UnitX();
  outline.nearest_m = outline.inside_m >= 0 ? centre_m : Vec3(radius_m * outline.outward);
  outline.nearest_m.z() = centre_m.z();
  return outline;
}

Penetration sphere(double tool_radius_m, const Vec3& centre_m, double radius_m) {
  HAPTO_ASSERT(tool_radius_m > 0 && radius_m >= 0);
  const double distance = centre_m.norm();
  return {.depth_m = tool_radius_m + radius_m - distance,
          .outward = distance > 0 ? Vec3(centre_m / distance) : Vec3::UnitZ(),
          .side = 0};
}

/// A shaft with a pointed end, thicker than a particle is deep: the nearest point of its side decides. Seen in the
/// plane through the axis and the centre, the side is a segment from the point to the base's rim and one up the shaft.
Penetration cone(const ToolParameters& tool, const Vec3& centre_m, double radius_m) {
  HAPTO_ASSERT(tool.cone_angle_rad > 0);
  HAPTO_ASSERT(tool.diameter_m > 0);
  const double rim = tool.diameter_m / 2;
  const double half_angle = tool.cone_angle_rad / 2;
  const double height = rim / portable::tan(half_angle);
  const double top = std::max(height, tool.length_m);
  const Eigen::Vector2d centre(portable::hypot(centre_m.x(), centre_m.y()), centre_m.z());
  const Vec3 radial = centre.x() > 0 ? Vec3(centre_m.x() / centre.x(), centre_m.y() / centre.x(), 0) : Vec3::UnitX();

  const Eigen::Vector2d along(portable::sin(half_angle),
                              portable::cos(half_angle));  // from the point up the cone's side
  const Eigen::Vector2d out(portable::cos(half_angle), -portable::sin(half_angle));
  const double slant = height / portable::cos(half_angle);
  const Eigen::Vector2d on_cone = std::clamp(centre.dot(along), 0.0, slant) * along;
  const Eigen::Vector2d on_shaft(rim, std::clamp(centre.y(), height, top));
  const bool shaft_nearer = (centre - on_shaft).squaredNorm() < (centre - on_cone).squaredNorm();
  const Eigen::Vector2d away = centre - (shaft_nearer ? on_shaft : on_cone);
  const Eigen::Vector2d normal = shaft_nearer ? Eigen::Vector2d(1, 0) : out;
  const bool inside = centre.y() > 0 && centre.dot(out) < 0 && centre.x() < rim && centre.y() < top;
  const double distance = inside ? -away.norm() : away.norm();
  constexpr double kOnTheSide_m = 1e-9;
  const Eigen::Vector2d direction = std::abs(distance) > kOnTheSide_m ? Eigen::Vector2d(away / distance) : normal;
  return {.depth_m = radius_m - distance, .outward = direction.x() * radial + direction.y() * Vec3::UnitZ(), .side = 0};
}

/// The wall is a cylinder that is `thickness_m` thick and rounded at its ends.
Penetration tube(const ToolParameters& tool, const Vec3& centre_m, double radius_m) {
  HAPTO_ASSERT(tool.thickness_m > 0);
  HAPTO_ASSERT(tool.diameter_m > 0);
  const double from_axis = portable::hypot(centre_m.x(), centre_m.y());
  const Vec3 radial = from_axis > 0 ? Vec3(centre_m.x() / from_axis, centre_m.y() / from_axis, 0) : Vec3::UnitX();
  Vec3 in_wall = tool.diameter_m / 2 * radial;
  in_wall.z() = std::clamp(centre_m.z(), -tool.length_m / 2, tool.length_m / 2);
  const Vec3 away = centre_m - in_wall;
  const double distance = away.norm();
  return {.depth_m = radius_m + tool.thickness_m / 2 - distance,
          .outward = distance > 0 ? Vec3(away / distance) : Vec3(-radial),
          .side = 0};
}

/// Next to the tool: the nearest point of a rim or an edge decides, which is unique there.
Penetration beside(const Outline& outline, double half_height_m, const Vec3& centre_m, double radius_m) {
  HAPTO_ASSERT(half_height_m > 0);
  Vec3 nearest = outline.nearest_m;
  nearest.z() = std::clamp(centre_m.z(), -half_height_m, half_height_m);
  const Vec3 away = centre_m - nearest;
  const double distance = away.norm();
  const int side = centre_m.z() > half_height_m ? 1 : centre_m.z() < -half_height_m ? -1 : 0;
  // A centre exactly on the rim has no direction.
  constexpr double kOnTheRim_m = 1e-9;
  return {.depth_m = radius_m - distance,
          .outward = distance > kOnTheRim_m ? Vec3(away / distance) : outline.outward,
          .side = side};
}

/// Over, under or inside the tool: measured from the face the particle came to.
Penetration overFace(const Outline& outline, double half_height_m, const Vec3& centre_m, double radius_m, int side) {
  HAPTO_ASSERT(half_height_m > 0);
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

// --- jaws ---

/// Two sides, each -1, 0 or 1, as one number from -4 to 4; 0 for neither side.
std::int8_t packed(const std::array<int, 2>& sides) {
  return static_cast<std::int8_t>(sides[0] + 3 * sides[1]);
}
std::array<int, 2> sidesOf(std::int8_t packed) {
  const int right = (packed + 4) / 3 - 1;
  return {packed - 3 * right, right};
}

/// Sets the shares of two contacts: see jawContacts().
void share(JawContacts& contacts, const ToolParameters& tool, double radius_m) {
  HAPTO_ASSERT(tool.opening_m >= 0);
  const bool right_deeper = contacts.jaws[1].found.depth_m > contacts.jaws[0].found.depth_m;
  JawContact& deeper = contacts.jaws[right_deeper ? 1 : 0];
  JawContact& other = contacts.jaws[right_deeper ? 0 : 1];
  const double one_surface = std::clamp(2 * deeper.found.outward.dot(other.found.outward), 0.0, 1.0);
  if (one_surface == 0 || other.found.depth_m < -tool.adhesion_ratio * radius_m) {
    return;
  }
  const auto to_surface = [radius_m](const Penetration& found) {
    return Vec3((found.depth_m - radius_m) * found.outward);
  };
  const double apart_m = (to_surface(deeper.found) - to_surface(other.found)).norm();
  const double slot = tool.opening_m < apart_m ? tool.opening_m / apart_m : tool.opening_m > 0 ? 1 : 0;
  const double depths = other.found.depth_m > 0 ? other.found.depth_m / deeper.found.depth_m : 0;
  deeper.share = 1 - one_surface * slot / 2 * depths;
  other.share = 1 - one_surface * (1 - slot / 2);
}

}  // namespace

Penetration penetration(const ToolParameters& tool, const Vec3& centre_m, double radius_m, int side) noexcept {
  HAPTO_ASSERT(tool.shape != ToolShape::kMesh || tool.mesh != nullptr);
  HAPTO_ASSERT(radius_m >= 0);
  const auto faced = [&](const Outline& outline, double half_height_m) {
    Penetration found = outline.inside_m < 0 ? beside(outline, half_height_m, centre_m, radius_m)
                                             : overFace(outline, half_height_m, centre_m, radius_m, side);
    if (found.depth_m < -tool.adhesion_ratio * radius_m) {
      found.side = 0;  // contact has ended
    }
    return found;
  };
  switch (tool.shape) {
    case ToolShape::kBox:
    case ToolShape::kJaws: return faced(boxOutline(tool.size_m / 2, centre_m), tool.size_m.z() / 2);
    case ToolShape::kSphere: return sphere(tool.diameter_m / 2, centre_m, radius_m);
    case ToolShape::kPlate: return faced(discOutline(tool.diameter_m / 2, centre_m), tool.thickness_m / 2);
    case ToolShape::kCylinder: return faced(discOutline(tool.diameter_m / 2, centre_m), tool.length_m / 2);
    case ToolShape::kCone: return cone(tool, centre_m, radius_m);
    case ToolShape::kTube: return tube(tool, centre_m, radius_m);
    case ToolShape::kMesh:
      return meshPenetration(tool.mesh->field, centre_m, radius_m, tool.adhesion_ratio * radius_m, side);
  }
  return {};
}

JawContacts jawContacts(const ToolParameters& tool, const Vec3& centre_m, double radius_m, std::int8_t sides) noexcept {
  HAPTO_ASSERT(tool.shape == ToolShape::kJaws);
  ToolParameters jaw = tool;
  jaw.shape = ToolShape::kBox;
  const std::array<int, 2> before = sidesOf(sides);
  JawContacts contacts;
  for (std::size_t i = 0; i < 2; ++i) {
    const JawShell shell(tool, i == 0 ? -1 : 1);
    const JawShell::Place place = shell.flattened(centre_m);
    contacts.jaws[i].found = penetration(jaw, place.flat_m, radius_m, before[i]);
    contacts.jaws[i].found.outward = shell.bent(contacts.jaws[i].found.outward, place);
  }
  contacts.sides = packed({contacts.jaws[0].found.side, contacts.jaws[1].found.side});
  share(contacts, tool, radius_m);
  return contacts;
}

double enclosingRadius(const ToolParameters& tool) noexcept {
  switch (tool.shape) {
    case ToolShape::kBox: return tool.size_m.norm() / 2;
    case ToolShape::kSphere: return tool.diameter_m / 2;
    case ToolShape::kPlate: return portable::hypot(tool.diameter_m, tool.thickness_m) / 2;
    case ToolShape::kCylinder: return portable::hypot(tool.diameter_m, tool.length_m) / 2;
    case ToolShape::kCone:
      return portable::hypot(tool.diameter_m / 2,
                             std::max(tool.length_m, tool.diameter_m / 2 / portable::tan(tool.cone_angle_rad / 2)));
    case ToolShape::kTube: return portable::hypot(tool.diameter_m, tool.length_m) / 2 + tool.thickness_m / 2;
    case ToolShape::kJaws: return cornersOf(tool).high_m.norm();
    case ToolShape::kMesh: return tool.mesh->field.enclosingRadius();
  }
  return 0;
}

ToolCorners cornersOf(const ToolParameters& tool) noexcept {
  const double r = tool.diameter_m / 2;
  const auto around = [](const Vec3& half) { return ToolCorners{-half, half}; };
  switch (tool.shape) {
    case ToolShape::kBox: return around(tool.size_m / 2);
    case ToolShape::kSphere: return around({r, r, r});
    case ToolShape::kPlate: return around({r, r, tool.thickness_m / 2});
    case ToolShape::kCylinder: return around({r, r, tool.length_m / 2});
    case ToolShape::kCone:
      return {{-r, -r, 0}, {r, r, std::max(tool.length_m, r / portable::tan(tool.cone_angle_rad / 2))}};
    case ToolShape::kTube: {
      const double outer = r + tool.thickness_m / 2;
      return around({outer, outer, (tool.length_m + tool.thickness_m) / 2});
    }
    case ToolShape::kJaws: {
      const JawShell right(tool, 1);
      return around({right.farthestX(), tool.size_m.y() / 2, right.halfHeight()});
    }
    case ToolShape::kMesh: return {tool.mesh->field.corners().low_m, tool.mesh->field.corners().high_m};
  }
  return around(Vec3::Constant(1e3));
}

}  // namespace haptolith
