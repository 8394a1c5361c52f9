#include "haptolith/tool/tool_part.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "haptolith/core/math/portable_math.h"
#include "haptolith/core/turn.h"

namespace haptolith {

namespace {

constexpr int kSides = 64;
constexpr int kRings = kSides / 2;  // rings of a sphere, from pole to pole

/// A closed solid; faces counter-clockwise seen from outside.
struct Solid {
  std::vector<Vec3> points_m;
  std::vector<std::vector<int>> faces;
};

Solid box(const Vec3& size_m) {
  Solid solid;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 side((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5, (corner & 4) != 0 ? 0.5 : -0.5);
    solid.points_m.emplace_back(side.cwiseProduct(size_m));
  }
  solid.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  return solid;
}

/// Solid of revolution of a line from one end of the axis to the other; its points off the axis, upwards, in between.
Solid turned(double low_m, double high_m, const std::vector<std::pair<double, double>>& radius_and_z_m) {
  Solid solid;
  solid.points_m = {Vec3(0, 0, low_m), Vec3(0, 0, high_m)};
  const auto rings = static_cast<int>(radius_and_z_m.size());
  for (const auto& [radius_m, z_m] : radius_and_z_m) {
    for (int side = 0; side < kSides; ++side) {
      const double angle = 2 * std::numbers::pi * side / kSides;
      solid.points_m.emplace_back(radius_m * portable::cos(angle), radius_m * portable::sin(angle), z_m);
    }
  }
  const auto at = [](int ring, int side) { return 2 + ring * kSides + side % kSides; };
  for (int side = 0; side < kSides; ++side) {
    solid.faces.push_back({0, at(0, side + 1), at(0, side)});
    for (int ring = 0; ring + 1 < rings; ++ring) {
      solid.faces.push_back({at(ring, side), at(ring, side + 1), at(ring + 1, side + 1), at(ring + 1, side)});
    }
    solid.faces.push_back({1, at(rings - 1, side), at(rings - 1, side + 1)});
  }
  return solid;
}

Solid solidOf(const ToolPart& part) {
  const double radius_m = part.diameter_m / 2;
  const double half_m = part.length_m / 2;
  switch (part.form) {
    case ToolPartForm::kBox: return box(part.size_m);
    case ToolPartForm::kCylinder: return turned(-half_m, half_m, {{radius_m, -half_m}, {radius_m, half_m}});
    case ToolPartForm::kSphere: break;
  }
  std::vector<std::pair<double, double>> rings;
  for (int ring = 1; ring < kRings; ++ring) {
    const double angle = std::numbers::pi * (static_cast<double>(ring) / kRings - 0.5);
    rings.emplace_back(radius_m * portable::cos(angle), radius_m * portable::sin(angle));
  }
  return turned(-radius_m, radius_m, rings);
}

void requireEach(const char* key, const Vec3& values, const Range& valid) {
  for (const double value : values) {
    requireInRange(key, value, valid);
  }
}

}  // namespace

void validate(const ToolPart& part) {
  if (part.form == ToolPartForm::kBox) {
    requireEach("size_m", part.size_m, ToolPartRanges::length_m);
  } else {
    requireInRange("diameter_m", part.diameter_m, ToolPartRanges::length_m);
  }
  if (part.form == ToolPartForm::kCylinder) {
    requireInRange("length_m", part.length_m, ToolPartRanges::length_m);
  }
  requireEach("at_m", part.at_m, ToolPartRanges::at_m);
  requireEach("turn_rad", part.turn_rad, ToolPartRanges::turn_rad);
  requireInRange("copies", part.copies, ToolPartRanges::count);
}

std::string drawn(std::span<const ToolPart> parts) {
  double count = 0;
  for (const ToolPart& part : parts) {
    validate(part);
    count += part.copies;
  }
  requireInRange("number of parts", count, ToolPartRanges::count);
  std::string text;
  int first = 1;
  for (const ToolPart& part : parts) {
    const Solid solid = solidOf(part);
    const Quat turn = turnAboutXyz(part.turn_rad);
    for (int copy = 0; copy < part.copies; ++copy) {
      const double angle_rad = 2 * std::numbers::pi * copy / part.copies;
      for (const Vec3& point_m : solid.points_m) {
        const Vec3 here_m = turn * point_m + part.at_m;
        const Vec3 at_mm = 1e3 * (copy == 0 ? here_m : Vec3(turnAbout(Vec3::UnitZ(), angle_rad) * here_m));
        fmt::format_to(std::back_inserter(text), "v {:.5f} {:.5f} {:.5f}\n", at_mm.x(), at_mm.y(), at_mm.z());
      }
      for (const std::vector<int>& face : solid.faces) {
        text += 'f';
        for (const int corner : face) {
          fmt::format_to(std::back_inserter(text), " {}", first + corner);
        }
        text += '\n';
      }
      first += static_cast<int>(solid.points_m.size());
    }
  }
  return text;
}

}  // namespace haptolith
