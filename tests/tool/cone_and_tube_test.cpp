#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "haptolith/tool/tool_shape.h"

namespace haptolith {
namespace {

constexpr double kRadius_m = 3e-3;
constexpr double kPi = std::numbers::pi;

/// 40 mm wide and 20 mm high, so that its side climbs at 45 degrees; its shaft ends at 100 mm.
ToolParameters blunt() {
  ToolParameters tool;
  tool.shape = ToolShape::kCone;
  tool.diameter_m = 0.04;
  tool.cone_angle_rad = kPi / 2;
  tool.length_m = 0.1;
  return tool;
}

ToolParameters penetrometer() {
  ToolParameters tool;
  tool.shape = ToolShape::kCone;
  tool.diameter_m = 0.02027;
  tool.length_m = 0.15;
  return tool;
}

/// 60 mm in the middle of its wall of 4 mm, 100 mm high.
ToolParameters ring() {
  ToolParameters tool;
  tool.shape = ToolShape::kTube;
  tool.diameter_m = 0.06;
  tool.thickness_m = 0.004;
  tool.length_m = 0.1;
  return tool;
}

void expectContact(const ToolParameters& tool, const Vec3& centre_mm, double depth_mm, const Vec3& outward) {
  const Penetration found = penetration(tool, 1e-3 * centre_mm, kRadius_m, 0);
  EXPECT_NEAR(1e3 * found.depth_m, depth_mm, 1e-9) << centre_mm.transpose();
  EXPECT_LT((found.outward - outward.normalized()).norm(), 1e-9) << centre_mm.transpose();
  EXPECT_EQ(found.side, 0);
}

/// As above for a cone by search: the nearest of many points on its side and shaft, and whether it holds the centre.
double distanceBySearch(const ToolParameters& tool, const Vec3& centre_m) {
  const double rim = tool.diameter_m / 2;
  const double height = rim / std::tan(tool.cone_angle_rad / 2);
  const double r = std::hypot(centre_m.x(), centre_m.y());
  const double z = centre_m.z();
  double nearest = 1e9;
  constexpr int kPoints = 20'000;
  for (int i = 0; i <= kPoints; ++i) {
    const double share = double(i) / kPoints;
    nearest = std::min(nearest, std::hypot(r - rim * share, z - height * share));
    nearest = std::min(nearest, std::hypot(r - rim, z - height - (tool.length_m - height) * share));
  }
  const bool inside = z > 0 && z < tool.length_m && r < rim * std::min(1.0, z / height);
  return inside ? -nearest : nearest;
}

TEST(Cone, UnderItsPointPushesStraightDown) {
  expectContact(blunt(), {0, 0, -2}, 1, {0, 0, -1});
  expectContact(blunt(), {0, 0, -4}, -1, {0, 0, -1});
}

TEST(Cone, PushesSquarelyOffItsSide) {
  const double a = 2 / std::sqrt(2.0);  // 2 mm off the middle of the side
  expectContact(blunt(), {10 + a, 0, 10 - a}, 1, {1, 0, -1});
  expectContact(blunt(), {0, -10 - a, 10 - a}, 1, {0, -1, -1});
  expectContact(blunt(), {10 - a, 0, 10 + a}, 5, {1, 0, -1});  // centre 2 mm inside
}

TEST(Cone, PushesSidewaysOffItsShaft) {
  expectContact(blunt(), {0, 22, 60}, 1, {0, 1, 0});
  expectContact(blunt(), {18, 0, 60}, 5, {1, 0, 0});
}

TEST(Cone, OnItsSideOrShaftHasADirection) {
  expectContact(blunt(), {10, 0, 10}, 3, {1, 0, -1});
  expectContact(blunt(), {20, 0, 50}, 3, {1, 0, 0});
}

TEST(Cone, IsAsFarFromAParticleAsTheNearestOfItsPoints) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> x(-0.03, 0.03);
  std::uniform_real_distribution<double> z(-0.01, 0.09);
  for (const ToolParameters& tool : {blunt(), penetrometer()}) {
    for (int i = 0; i < 300; ++i) {
      const Vec3 centre(x(random), x(random), z(random));
      const Penetration found = penetration(tool, centre, kRadius_m, 0);
      EXPECT_NEAR(found.depth_m, kRadius_m - distanceBySearch(tool, centre), 2e-6) << centre.transpose();
      EXPECT_NEAR(found.outward.norm(), 1, 1e-9);
      EXPECT_LE(found.outward.z(), found.depth_m > kRadius_m ? 0 : 1);  // from inside never up
    }
  }
}

TEST(Cone, WhoseLengthIsLessThanItsPointStillHasAllOfItsPoint) {
  ToolParameters stub = blunt();
  stub.length_m = 0.001;
  const double a = 2 / std::sqrt(2.0);
  expectContact(stub, {10 - a, 0, 10 + a}, 5, {1, 0, -1});
  EXPECT_NEAR(enclosingRadius(stub), std::hypot(0.02, 0.02), 1e-12);
}

TEST(Cone, LiesWithinItsEnclosingRadius) {
  for (const ToolParameters& tool : {blunt(), penetrometer(), ring()}) {
    const double outside = enclosingRadius(tool) + kRadius_m + 1e-9;
    std::mt19937 random(6);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
      EXPECT_LT(penetration(tool, outside * direction, kRadius_m, 0).depth_m, 0);
    }
  }
}

TEST(Tube, PushesOutsideOutwardsAndInsideInwards) {
  expectContact(ring(), {34, 0, 20}, 1, {1, 0, 0});
  expectContact(ring(), {0, -26, -30}, 1, {0, 1, 0});
  expectContact(ring(), {0, 0, 0}, 3 + 2 - 30, {-1, 0, 0});
}

TEST(Tube, HasARoundedEndAndIsOpen) {
  expectContact(ring(), {30, 0, -54}, 1, {0, 0, -1});
  EXPECT_LT(penetration(ring(), {0, 0, -0.05}, kRadius_m, 0).depth_m, 0);
}

}  // namespace
}  // namespace haptolith
