#include "haptolith/tool/tool_surface.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

#include "haptolith/tool/tool_shape.h"

namespace haptolith {
namespace {

/// By the divergence theorem; > 0 when the triangles look outwards.
double volume(const ToolSurface& surface) {
  double sum = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const auto at = [&](std::int32_t i) -> const Vec3& { return surface.points_tool_m[static_cast<std::size_t>(i)]; };
    sum += at(a).dot(at(b).cross(at(c))) / 6;
  }
  return sum;
}

/// Each edge belongs to two triangles, which pass it in opposite directions.
bool isClosed(const ToolSurface& surface) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const auto& [a, b, c] : surface.triangles) {
    ++edges[{a, b}];
    ++edges[{b, c}];
    ++edges[{c, a}];
  }
  return std::ranges::all_of(edges, [&](const auto& edge) {
    const auto back = edges.find({edge.first.second, edge.first.first});
    return edge.second == 1 && back != edges.end() && back->second == 1;
  });
}

double reach(const ToolSurface& surface) {
  double reach_m = 0;
  for (const Vec3& point : surface.points_tool_m) {
    reach_m = std::max(reach_m, point.norm());
  }
  return reach_m;
}

TEST(ToolSurface, EnclosesTheVolumeOfEachTool) {
  constexpr double kPi = std::numbers::pi;
  // 50 x 40 x 5 mm; 60 mm across, 5 mm thick, 150 mm long; a cone of 30 degrees.
  const double cone_height_m = 0.03 / std::tan(kPi / 12);
  const std::pair<ToolShape, double> volumes_m3[]{
      {ToolShape::kBox, 0.05 * 0.04 * 0.005},
      {ToolShape::kSphere, 4.0 / 3 * kPi * std::pow(0.03, 3)},
      {ToolShape::kPlate, kPi * 0.03 * 0.03 * 0.005},
      {ToolShape::kCone, kPi * 0.03 * 0.03 * (cone_height_m / 3 + 0.15 - cone_height_m)},
      {ToolShape::kCylinder, kPi * 0.03 * 0.03 * 0.15},
      {ToolShape::kTube, kPi * 0.06 * (0.15 * 0.005 + kPi * 0.0025 * 0.0025)},  // Guldin
      {ToolShape::kJaws, 2 * 0.05 * 0.04 * 0.005},
  };
  for (const auto& [shape, volume_m3] : volumes_m3) {
    ToolParameters tool;
    tool.shape = shape;
    tool.length_m = 0.15;
    const ToolSurface surface = toolSurface(tool, tool.opening_m);
    EXPECT_TRUE(isClosed(surface)) << static_cast<int>(shape);
    EXPECT_LE(volume(surface), volume_m3 * (1 + 1e-9)) << static_cast<int>(shape);
    EXPECT_GT(volume(surface), 0.98 * volume_m3) << static_cast<int>(shape);
    EXPECT_LE(reach(surface), enclosingRadius(tool) * (1 + 1e-9)) << static_cast<int>(shape);
    const auto [low_m, high_m] = cornersOf(tool);
    Vec3 lowest_m = high_m;
    Vec3 highest_m = low_m;
    for (const Vec3& point : surface.points_tool_m) {
      lowest_m = lowest_m.cwiseMin(point);
      highest_m = highest_m.cwiseMax(point);
    }
    EXPECT_LT((lowest_m - low_m).norm() + (highest_m - high_m).norm(), 1e-4) << "the box around it, less the roundness";
  }
}

TEST(ToolSurface, LiesWhereContactBegins) {
  for (const ToolShape shape : kToolShapes) {
    if (shape == ToolShape::kJaws) {
      continue;  // whose contacts are two
    }
    ToolParameters tool;
    tool.shape = shape;
    tool.length_m = 0.15;
    for (const Vec3& point : toolSurface(tool, 0).points_tool_m) {
      if (shape == ToolShape::kCone && point == Vec3(0, 0, tool.length_m)) {
        continue;  // a shaft's upper end is above the soil, and contact does not know it
      }
      EXPECT_NEAR(penetration(tool, point, 0, 0).depth_m, 0, 1e-6) << static_cast<int>(shape);
    }
  }
}

TEST(ToolSurface, JawsStandApartByTheirOpening) {
  ToolParameters tool;
  tool.shape = ToolShape::kJaws;
  for (const double opening_m : {0.0, 0.03}) {
    double innermost_m = 1;
    double outermost_m = 0;
    for (const Vec3& point : toolSurface(tool, opening_m).points_tool_m) {
      innermost_m = std::min(innermost_m, std::abs(point.x()));
      outermost_m = std::max(outermost_m, std::abs(point.x()));
    }
    EXPECT_DOUBLE_EQ(innermost_m, opening_m / 2);
    EXPECT_DOUBLE_EQ(outermost_m, opening_m / 2 + 0.005);
  }
}

TEST(ToolSurface, AConeShorterThanItsPointHasNoShaft) {
  ToolParameters tool;
  tool.shape = ToolShape::kCone;
  tool.length_m = 0.01;
  const ToolSurface surface = toolSurface(tool, 0);
  EXPECT_TRUE(isClosed(surface));
  EXPECT_NEAR(volume(surface), std::numbers::pi * 0.03 * 0.03 * 0.03 / std::tan(std::numbers::pi / 12) / 3, 1e-6);
}

}  // namespace
}  // namespace haptolith
