#include "haptolith/tool/tool_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace haptolith {
namespace {

constexpr double kRadius_m = 7e-3;

// The paper's shovel: 50 x 40 x 5 mm, so its faces are at 25, 20 and 2.5 mm.
const ToolParameters kShovel;

ToolParameters sphereTool() {
  ToolParameters tool;
  tool.shape = ToolShape::kSphere;
  tool.diameter_m = 0.06;
  return tool;
}

ToolParameters plateTool() {
  ToolParameters tool;
  tool.shape = ToolShape::kPlate;
  tool.diameter_m = 0.06;
  tool.thickness_m = 0.005;
  return tool;
}

void expectContact(const ToolParameters& tool, const Vec3& centre_mm, double depth_mm, const Vec3& outward, int side) {
  const Penetration found = penetration(tool, 1e-3 * centre_mm, kRadius_m, 0);
  EXPECT_NEAR(1e3 * found.depth_m, depth_mm, 1e-9) << centre_mm.transpose();
  EXPECT_LT((found.outward - outward.normalized()).norm(), 1e-12) << centre_mm.transpose();
  EXPECT_EQ(found.side, side) << centre_mm.transpose();
}

TEST(Box, LargeFaces) {
  expectContact(kShovel, {10, -5, 8.5}, 1, {0, 0, 1}, 1);
  expectContact(kShovel, {10, -5, -8.5}, 1, {0, 0, -1}, -1);
  expectContact(kShovel, {0, 0, 9.5}, 0, {0, 0, 1}, 1);
  expectContact(kShovel, {0, 0, 1}, 8.5, {0, 0, 1}, 1);  // inside, nearest to the upper face
}

TEST(Box, SmallFaces) {
  expectContact(kShovel, {31, 3, 1}, 1, {1, 0, 0}, 0);
  expectContact(kShovel, {-31, 3, 1}, 1, {-1, 0, 0}, 0);
  expectContact(kShovel, {3, 26, -2}, 1, {0, 1, 0}, 0);
  expectContact(kShovel, {3, -26, -2}, 1, {0, -1, 0}, 0);
}

TEST(Box, EdgesAndCorners) {
  // 3 mm outside and 4 mm above an edge: 5 mm from it, 2 mm of the sphere inside.
  expectContact(kShovel, {28, 0, 6.5}, 2, {3, 0, 4}, 1);
  expectContact(kShovel, {0, -23, -6.5}, 2, {0, -3, -4}, -1);
  expectContact(kShovel, {28, 24, 0}, 2, {3, 4, 0}, 0);  // an upright edge
  // 2, 3 and 6 mm from a corner: 7 mm, so the sphere just touches it.
  expectContact(kShovel, {27, 23, 8.5}, 0, {2, 3, 6}, 1);
  expectContact(kShovel, {-26, -22, -4.5}, 4, {-1, -2, -2}, -1);
}

TEST(Box, OutOfReachLetsGoOfTheSide) {
  const Penetration far = penetration(kShovel, Vec3(0, 0, 0.05), kRadius_m, 1);
  EXPECT_LT(far.depth_m, 0);
  EXPECT_EQ(far.side, 0);
}

TEST(Sphere, MeasuresAlongTheLineOfCentres) {
  expectContact(sphereTool(), {0, 0, 36}, 1, {0, 0, 1}, 0);
  expectContact(sphereTool(), {12, 16, 21}, 37 - 29, {12, 16, 21}, 0);  // 12-16-21: 29 mm
  expectContact(sphereTool(), {-40, 0, 0}, -3, {-1, 0, 0}, 0);
}

TEST(Plate, FacesRimAndEdge) {
  expectContact(plateTool(), {10, 10, 8.5}, 1, {0, 0, 1}, 1);
  expectContact(plateTool(), {10, 10, -8.5}, 1, {0, 0, -1}, -1);
  expectContact(plateTool(), {21.6, 28.8, 1}, 1, {3, 4, 0}, 0);  // 36 mm from the axis: 6 mm outside the rim
  expectContact(plateTool(), {33, 0, 6.5}, 2, {3, 0, 4}, 1);     // over the edge
}

ToolParameters ofShape(ToolShape shape) {
  ToolParameters tool;
  tool.shape = shape;
  return tool;
}

TEST(Shapes, ACentreInTheMiddleStillGivesANormal) {
  for (const ToolParameters& tool : {kShovel, sphereTool(), plateTool()}) {
    for (const int side : {-1, 0, 1}) {
      const Penetration middle = penetration(tool, Vec3::Zero(), kRadius_m, side);
      EXPECT_NEAR(middle.outward.norm(), 1, 1e-12);
      EXPECT_TRUE(std::isfinite(middle.depth_m));
    }
  }
}

TEST(Plate, ACentreOnTheRimToTheLastBitStillGivesANormal) {
  // Just outside the rim, within a rounding of it, the nearest point of the rim can be the centre itself.
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> turn(0, 6.283);
  for (int i = 0; i < 200'000; ++i) {
    const double angle = turn(random);
    double radius = 0.03;
    for (int ulp = 0; ulp < 3; ++ulp) {
      radius = std::nextafter(radius, 1.0);
      const Penetration on_rim =
          penetration(plateTool(), Vec3(radius * std::cos(angle), radius * std::sin(angle), 0.001), kRadius_m, 0);
      ASSERT_NEAR(on_rim.outward.dot(Vec3(std::cos(angle), std::sin(angle), 0)), 1, 1e-6) << angle;
      ASSERT_NEAR(on_rim.depth_m, kRadius_m, 1e-12);
    }
  }
}

TEST(Box, AParticleKeepsTheFaceItCameTo) {
  // Pressed from above down to the lower face: the depth keeps growing, the normal stays.
  for (double z_mm = 9; z_mm > -9; z_mm -= 0.25) {
    const Penetration pressed = penetration(kShovel, Vec3(0, 0, 1e-3 * z_mm), kRadius_m, 1);
    ASSERT_EQ(pressed.side, 1) << z_mm;
    ASSERT_EQ(pressed.outward, Vec3(0, 0, 1)) << z_mm;
    ASSERT_NEAR(1e3 * pressed.depth_m, 9.5 - z_mm, 1e-9);
  }
  // Wholly through: it belongs to the other side and is out of touch.
  const Penetration through = penetration(kShovel, Vec3(0, 0, -0.00951), kRadius_m, 1);
  EXPECT_LT(through.depth_m, 0);
}

TEST(Box, AParticleThatCameInOverTheRimGoesOutOverIt) {
  const Penetration over_rim = penetration(kShovel, Vec3(0.024, 0, 0.001), kRadius_m, 0);
  EXPECT_EQ(over_rim.outward, Vec3(1, 0, 0));
  EXPECT_NEAR(over_rim.depth_m, 0.008, 1e-12);
}

TEST(Shapes, DepthIsContinuousAwayFromTheInside) {
  // Outside the tool no step of 10 um changes the depth by more than 10 um, whichever feature is nearest.
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> sideways(-0.04, 0.04);
  std::uniform_real_distribution<double> small(-1, 1);
  for (const ToolParameters& tool : {kShovel, sphereTool(), plateTool()}) {
    for (int i = 0; i < 20'000; ++i) {
      const Vec3 here(sideways(random), sideways(random),
                      std::copysign(0.0026 + std::abs(sideways(random)) / 4, small(random)));
      const Vec3 there = here + 1e-5 * Vec3(small(random), small(random), 0).normalized();
      const double change =
          penetration(tool, here, kRadius_m, 0).depth_m - penetration(tool, there, kRadius_m, 0).depth_m;
      ASSERT_LE(std::abs(change), 1e-5 * (1 + 1e-9)) << here.transpose();
    }
  }
}

TEST(Shapes, EnclosingSphereHoldsTheTool) {
  EXPECT_NEAR(enclosingRadius(kShovel), std::sqrt(25.0 * 25 + 20 * 20 + 2.5 * 2.5) * 1e-3, 1e-15);
  EXPECT_NEAR(enclosingRadius(sphereTool()), 0.03, 1e-15);
  EXPECT_NEAR(enclosingRadius(plateTool()), std::hypot(30, 2.5) * 1e-3, 1e-15);
}

/// Distance from the surface of a closed cylinder by search, < 0 inside: the nearest of many points of its wall and
/// ends, in the plane through the axis and the point.
double distanceBySearch(const ToolParameters& cylinder, const Vec3& point) {
  const double r = cylinder.diameter_m / 2;
  const double half = cylinder.length_m / 2;
  const double from_axis = std::hypot(point.x(), point.y());
  double nearest = 1;
  constexpr int kPoints = 20'000;
  for (int i = 0; i <= kPoints; ++i) {
    const double share = double(i) / kPoints;
    nearest = std::min(nearest, std::hypot(from_axis - r, point.z() - half * (2 * share - 1)));
    nearest = std::min(nearest, std::hypot(from_axis - share * r, std::abs(point.z()) - half));
  }
  return from_axis < r && std::abs(point.z()) < half ? -nearest : nearest;
}

TEST(Cylinder, TouchesWhereTheSearchedSurfaceDoes) {
  ToolParameters corer = ofShape(ToolShape::kCylinder);
  corer.diameter_m = 0.04;
  corer.length_m = 0.1;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < 300; ++i) {
    const Vec3 centre(0.04 * any(random), 0.04 * any(random), 0.07 * any(random));
    const Penetration found = penetration(corer, centre, kRadius_m, 0);
    EXPECT_NEAR(found.depth_m, kRadius_m - distanceBySearch(corer, centre), 1e-5) << centre.transpose();
    const double step_m = 1e-5;
    const double farther = penetration(corer, centre + step_m * found.outward, kRadius_m, 0).depth_m;
    EXPECT_NEAR(found.depth_m - farther, step_m, 1e-8)
        << "outward is where it is left fastest, at " << centre.transpose();
  }
}

TEST(Cylinder, IsAPlateThatIsAsHighAsItIsLong) {
  ToolParameters plate = plateTool();
  ToolParameters cylinder = plate;
  cylinder.shape = ToolShape::kCylinder;
  cylinder.length_m = plate.thickness_m;
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> any(-0.045, 0.045);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 centre(any(random), any(random), any(random) / 3);
    for (const int side : {-1, 0, 1}) {
      const Penetration one = penetration(plate, centre, kRadius_m, side);
      const Penetration other = penetration(cylinder, centre, kRadius_m, side);
      EXPECT_EQ(one.depth_m, other.depth_m);
      EXPECT_EQ(one.outward, other.outward);
      EXPECT_EQ(one.side, other.side);
    }
  }
}

}  // namespace
}  // namespace haptolith
