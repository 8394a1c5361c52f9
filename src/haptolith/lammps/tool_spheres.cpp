#include "haptolith/lammps/tool_spheres.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/tool/tool_shape.h"
#include "haptolith/tool/tool_surface.h"

namespace haptolith {

namespace {

constexpr std::size_t kMostSpheres = 1'000'000;

/// Half of the tool's smallest dimension, as far as its parameters give it.
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
    constexpr int kBits = 21;  // bits per axis: two million cells
    std::uint64_t joined = 0;
    for (const std::int64_t part : cell) {
      joined = joined << kBits | (static_cast<std::uint64_t>(part) & ((1U << kBits) - 1));
    }
    return joined;
  }

  double apart_m_;
  std::unordered_multimap<std::uint64_t, Vec3> cells_;
};

/// Moves a point into the tool until a sphere around it touches the surface from inside, if there is room.
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
      throw InvalidParameter("tool", "too large compared with the particles",
                             fmt::format("a tool that {} spheres of {:.3g} mm cover", kMostSpheres, 1e3 * radius_m));
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

SpheresUnderAGrain spheresUnderAGrain(const ToolSpheres& spheres, const ToolParameters& tool, double grain_radius_m) {
  constexpr double kPressed = 0.05;  // fraction of a particle's radius
  constexpr int kGrains = 200;
  const ToolSurface surface = toolSurface(tool, 0);
  std::vector<double> areas;
  for (const auto& corners : surface.triangles) {
    const auto corner = [&](std::size_t i) { return surface.points_tool_m[static_cast<std::size_t>(corners.at(i))]; };
    areas.push_back((corner(1) - corner(0)).cross(corner(2) - corner(0)).norm());
  }
  std::mt19937_64 random(1);
  std::discrete_distribution<std::size_t> triangle(areas.begin(), areas.end());
  std::uniform_real_distribution<double> share(0, 1);
  SpheresUnderAGrain found{.pressed_m = kPressed * grain_radius_m};
  std::vector<double> counts, depths;
  for (int grain = 0; grain < kGrains; ++grain) {
    const auto& corners = surface.triangles[triangle(random)];
    const auto corner = [&](std::size_t i) { return surface.points_tool_m[static_cast<std::size_t>(corners.at(i))]; };
    double u = share(random), v = share(random);
    u = u + v > 1 ? 1 - u : u;
    v = u + v > 1 ? 1 - v : v;
    const Vec3 along = corner(1) - corner(0), across = corner(2) - corner(0);
    const Vec3 centre =
        corner(0) + u * along + v * across + (grain_radius_m - found.pressed_m) * along.cross(across).normalized();
    double count = 0, depth_m = 0;
    for (const Vec3& sphere : spheres.centres_tool_m) {
      const double in_m = grain_radius_m + spheres.radius_m - (sphere - centre).norm();
      count += in_m > 0 ? 1 : 0;
      depth_m += std::max(0.0, in_m);
    }
    counts.push_back(count);
    depths.push_back(depth_m);
  }
  const auto middle_of = [](std::vector<double>& numbers) {
    std::ranges::nth_element(numbers, numbers.begin() + kGrains / 2);
    return numbers[kGrains / 2];
  };
  found.count = std::max(1.0, middle_of(counts));
  found.depth_m = std::max(found.pressed_m, middle_of(depths));
  return found;
}

}  // namespace haptolith
