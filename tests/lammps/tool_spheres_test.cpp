#include "haptolith/lammps/tool_spheres.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "haptolith/tool/tool_shape.h"
#include "haptolith/tool/tool_surface.h"

namespace haptolith {
namespace {

ToolParameters of(ToolShape shape) {
  ToolParameters tool;
  tool.shape = shape;
  tool.length_m = 0.06;
  return tool;
}

class SpheresOf : public testing::TestWithParam<ToolShape> {};

TEST_P(SpheresOf, StayInsideTheTool) {
  const ToolParameters tool = of(GetParam());
  const ToolSpheres spheres = toolSpheres(tool, 0, 2e-3);
  ASSERT_FALSE(spheres.centres_tool_m.empty());
  EXPECT_LE(spheres.radius_m, 2e-3);
  for (const Vec3& centre : spheres.centres_tool_m) {
    // A point as deep as the sphere is large, or less where the tool has an edge sharper than that.
    EXPECT_LE(std::abs(penetration(tool, centre, 0, 0).depth_m), spheres.radius_m * 1.05);
  }
}

TEST_P(SpheresOf, LeaveNoHoles) {
  const ToolParameters tool = of(GetParam());
  const ToolSpheres spheres = toolSpheres(tool, 0, 2e-3);
  const ToolSurface surface = toolSurface(tool, 0);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  // A grain of 6 mm on the surface: how far it could sink between the spheres. At edges, which they round, it is more.
  constexpr double kGrain_m = 6e-3;
  std::vector<double> sunk_m;
  for (const auto& corners : surface.triangles) {
    const Vec3& a = surface.points_tool_m[static_cast<std::size_t>(corners[0])];
    const Vec3 along = surface.points_tool_m[static_cast<std::size_t>(corners[1])] - a;
    const Vec3 across = surface.points_tool_m[static_cast<std::size_t>(corners[2])] - a;
    const Vec3 normal = along.cross(across).normalized();
    for (int i = 0; i < 20; ++i) {
      double u = share(random), v = share(random);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const Vec3 grain = a + u * along + v * across + kGrain_m * normal;
      double gap_m = 1;
      for (const Vec3& centre : spheres.centres_tool_m) {
        gap_m = std::min(gap_m, (centre - grain).norm() - spheres.radius_m - kGrain_m);
      }
      sunk_m.push_back(gap_m);
    }
  }
  ASSERT_GT(sunk_m.size(), 100U);
  std::ranges::sort(sunk_m);
  EXPECT_LT(sunk_m[sunk_m.size() * 7 / 10], 3.5e-4);
  EXPECT_LT(sunk_m.back(), 1.3e-3);
}

INSTANTIATE_TEST_SUITE_P(Shapes, SpheresOf,
                         testing::Values(ToolShape::kBox, ToolShape::kSphere, ToolShape::kPlate, ToolShape::kCylinder));

TEST(ToolSpheres, AreManyUnderAGrain) {
  ToolParameters ball;
  ball.shape = ToolShape::kSphere;
  const ToolSpheres spheres = toolSpheres(ball, 0, 2e-3);
  const SpheresUnderAGrain under = spheresUnderAGrain(spheres, ball, 6e-3);
  EXPECT_DOUBLE_EQ(under.pressed_m, 0.3e-3);
  // A grain that is in a plane of n spheres per area by z touches 2 pi (R + r) z n of them, z / 2 deep in the mean.
  const double per_area = static_cast<double>(spheres.centres_tool_m.size()) / (4 * M_PI * 0.03 * 0.03);
  EXPECT_NEAR(under.count / (2 * M_PI * 8e-3 * 0.3e-3 * per_area), 1, 0.25);
  EXPECT_NEAR(under.depth_m / under.count, 0.15e-3, 0.06e-3);
}

TEST(ToolSpheres, AreAsThinAsTheTool) {
  ToolParameters shovel;
  const ToolSpheres spheres = toolSpheres(shovel, 0, 4e-3);
  EXPECT_DOUBLE_EQ(spheres.radius_m, 2.5e-3);  // half of a 5 mm sheet
  for (const Vec3& centre : spheres.centres_tool_m) {
    EXPECT_NEAR(centre.z(), 0, 1e-5);
    EXPECT_LE(std::abs(centre.x()), 0.0225 + 1e-5);
    EXPECT_LE(std::abs(centre.y()), 0.0175 + 1e-5);
  }
}

}  // namespace
}  // namespace haptolith
