#include "haptolith/exchange/tool_spheres.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "haptolith/core/error.h"
#include "haptolith/tool/tool_shape.h"
#include "haptolith/tool/tool_surface.h"

namespace haptolith {

namespace {

constexpr std::size_t kMostSpheres = 1'000'000;

/// Half of how thin the tool is, as far as its numbers tell.
double halfThickness(const ToolParameters& tool, double most_m) {
  switch (tool.shape) {
    case ToolShape::kBox:
    case ToolShape::kJaws: return std::min(most_m, tool.size_m.minCoeff() / 2);
    case ToolShape::kPlate:
    case ToolShape::kTube: return std::min({most_m, tool.thickness_m / 2, tool.diameter_m / 2});
    case ToolShape::kSphere:
    case ToolShape::kCone:
    case ToolShape::kCylinder: return std::min(most_m, tool.diameter_m / 2);
    case ToolShape::kMesh: return most_m;
  }
  return most_m;
}

/// Sets points apart: a new one counts only where none of the others is nearer than `apart_m`.
class Apart {
 public:
  explicit Apart(double apart_m) : apart_m_(apart_m) {}

  bool add(const Vec3& point) {
    const std::array<std::int64_t, 3> cell = cellOf(point);
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto [first, last] = cells_.equal_range(key({cell[0] + x, cell[1] + y, cell[2] + z}));
          if (std::any_of(first, last, [&](const auto& kept) { return (kept.second - point).norm() < apart_m_; })) {
            return false;
          }
        }
      }
    }
    cells_.emplace(key(cell), point);
    return true;
  }

 private:
  [[nodiscard]] std::array<std::int64_t, 3> cellOf(const Vec3& point) const {
    const auto along = [&](int axis) { return static_cast<std::int64_t>(std::floor(point[axis] / apart_m_)); };
    return {along(0), along(1), along(2)};
  }
  static std::uint64_t key(const std::array<std::int64_t, 3>& cell) {
    constexpr int kBits = 21;  // of each axis: two million cells
    std::uint64_t joined = 0;
    for (const std::int64_t part : cell) {
      joined = joined << kBits | (static_cast<std::uint64_t>(part) & ((1U << kBits) - 1));
    }
    return joined;
  }

  double apart_m_;
  std::unordered_multimap<std::uint64_t, Vec3> cells_;
};

/// Moves a point so far into the tool that a sphere around it touches the surface from inside; as far as there is room.
Vec3 pulledIn(const ToolParameters& tool, Vec3 point, double radius_m) {
  constexpr int kMostMoves = 8;
  for (int move = 0; move < kMostMoves; ++move) {
    const Penetration found = penetration(tool, point, 0, 0);
    const double lacks_m = radius_m - found.depth_m;
    if (std::abs(lacks_m) < 1e-3 * radius_m) {
      break;
    }
    point -= lacks_m * found.outward;
  }
  return point;
}

}  // namespace

ToolSpheres toolSpheres(const ToolParameters& tool, double opening_m, double most_radius_m) {
  ToolSpheres spheres;
  spheres.radius_m = halfThickness(tool, most_radius_m);
  const double radius_m = spheres.radius_m;
  const ToolSurface surface = toolSurface(tool, opening_m);
  Apart apart(0.7 * radius_m);
  for (const auto& corners : surface.triangles) {
    const auto corner = [&](std::size_t i) { return surface.points_tool_m[static_cast<std::size_t>(corners.at(i))]; };
    const Vec3 a = corner(0), along = corner(1) - a, across = corner(2) - a;
    const Vec3 normal = along.cross(across);
    if (normal.norm() == 0) {
      continue;
    }
    const double longest_m = std::max({along.norm(), across.norm(), (across - along).norm()});
    const auto steps = static_cast<std::size_t>(std::ceil(longest_m / (0.9 * radius_m)));
    if (steps * steps / 2 + spheres.centres_tool_m.size() > kMostSpheres) {
      throw InvalidParameter("tool", "so large beside the soil's grains",
                             fmt::format("one that {} spheres of {:.3g} mm cover", kMostSpheres, 1e3 * radius_m));
    }
    const Vec3 inwards = -normal.normalized();
    for (std::size_t i = 0; i <= steps; ++i) {
      for (std::size_t j = 0; i + j <= steps; ++j) {
        const double per = 1.0 / static_cast<double>(steps);
        const Vec3 on = a + static_cast<double>(i) * per * along + static_cast<double>(j) * per * across;
        Vec3 centre = on + radius_m * inwards;
        if (tool.shape != ToolShape::kJaws) {
          centre = pulledIn(tool, centre, radius_m);
        }
        if (apart.add(centre)) {
          spheres.centres_tool_m.push_back(centre);
        }
      }
    }
  }
  return spheres;
}

}  // namespace haptolith
