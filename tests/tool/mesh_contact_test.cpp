#include "haptolith/tool/mesh_contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "haptolith/core/math/random.h"
#include "haptolith/mesh/mend.h"
#include "haptolith/tool/tool_surface.h"

namespace haptolith {
namespace {

constexpr double kRadius_m = 7e-3;
constexpr double kLetsGo_m = 0.002 * kRadius_m;

DistanceField fieldOf(const ToolParameters& tool) {
  const ToolSurface surface = toolSurface(tool, 0);
  return makeDistanceField(mend({.points_m = surface.points_tool_m, .triangles = surface.triangles}),
                           {.spacing_m = 0.4e-3, .band_m = 9e-3});
}

ToolParameters boxOf(const Vec3& size_m) {
  ToolParameters tool;
  tool.size_m = size_m;
  return tool;
}

Vec3 anywhere(std::mt19937_64& random, const Vec3& half_m) {
  return {half_m.x() * uniformSigned(random), half_m.y() * uniformSigned(random), half_m.z() * uniformSigned(random)};
}

TEST(MeshContact, ADirectionIsWithinSeventeenDegreesOfItsCode) {
  std::mt19937_64 random(1);
  double worst = 1;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 direction = anywhere(random, Vec3::Ones()).normalized();
    const int code = directionCode(direction);
    ASSERT_GE(code, 1);
    ASSERT_LE(code, 225);
    worst = std::min(worst, directionOf(code).dot(direction));
    // At the seams of the unfolded octahedron a direction has two numbers.
    ASSERT_NEAR(directionOf(directionCode(directionOf(code))).dot(directionOf(code)), 1, 1e-12)
        << direction.transpose();
  }
  EXPECT_GT(worst, std::cos(17 * std::numbers::pi / 180));
  EXPECT_EQ(directionCode(Vec3::Zero()), 0);
}

TEST(MeshContact, MeetsAParticleOutsideAsTheExactBoxDoes) {
  const ToolParameters box = boxOf({0.05, 0.04, 0.005});
  const DistanceField field = fieldOf(box);
  std::mt19937_64 random(2);
  int met = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 centre = anywhere(random, {0.035, 0.03, 0.011});
    if ((centre.cwiseAbs() - box.size_m / 2).maxCoeff() < 2 * field.spacing()) {
      continue;  // inside, which side it came from decides; and the field rounds edges off by as much as its spacing
    }
    const Penetration exact = penetration(box, centre, kRadius_m, 0);
    const Penetration found = meshPenetration(field, centre, kRadius_m, kLetsGo_m, 0);
    if (exact.depth_m < 0) {
      continue;
    }
    ++met;
    EXPECT_NEAR(found.depth_m, exact.depth_m, 0.1e-3) << centre.transpose();
    EXPECT_GT(found.outward.dot(exact.outward), std::cos(0.15)) << centre.transpose();
    EXPECT_NE(found.side, 0);
  }
  EXPECT_GT(met, 3000);
}

/// Presses a particle down through the centre of a wall, and returns its depth at each place.
TEST(MeshContact, AParticleThatIsPressedIntoAThinWallStaysOnItsSide) {
  constexpr double kWall_m = 1e-3;
  const DistanceField field = fieldOf(boxOf({0.06, 0.06, kWall_m}));
  for (const double from : {1.0, -1.0}) {
    int side = 0;
    for (double height_m = kRadius_m; height_m > -0.9 * kRadius_m; height_m -= 0.2e-3) {  // 1 m/s and 0.2 ms
      const Penetration found = meshPenetration(field, {0.003, -0.007, from * height_m}, kRadius_m, kLetsGo_m, side);
      side = found.side;
      if (height_m < kRadius_m - 1e-3) {
        EXPECT_NEAR(found.depth_m, kRadius_m + kWall_m / 2 - height_m, 0.02e-3) << from << " " << height_m;
        EXPECT_GT(found.outward.z() * from, 0.999) << from << " " << height_m;
        EXPECT_NE(side, 0);
      }
    }
    const Penetration behind =
        meshPenetration(field, {0.003, -0.007, -1.2 * from * kRadius_m}, kRadius_m, kLetsGo_m, side);
    EXPECT_EQ(behind.side, 0) << "wholly on the other side";
    EXPECT_LT(behind.depth_m, 0);
  }
}

TEST(MeshContact, AParticleBetweenTwoWallsStaysThereHoweverNarrowItIs) {
  // Two walls of 4 mm, 10 mm apart, and a particle of 14 mm that slides in between them and from one to the other.
  TriangleMesh walls;
  for (const double middle_m : {-0.007, 0.007}) {
    const ToolSurface surface = toolSurface(boxOf({0.06, 0.004, 0.06}), 0);
    const auto first = static_cast<std::int32_t>(walls.points_m.size());
    for (const Vec3& point_m : surface.points_tool_m) {
      walls.points_m.emplace_back(point_m + Vec3(0, middle_m, 0));
    }
    for (const auto& [a, b, c] : surface.triangles) {
      walls.triangles.push_back({a + first, b + first, c + first});
    }
  }
  const DistanceField field = makeDistanceField(mend(walls), {.spacing_m = 0.4e-3, .band_m = 9e-3});
  int side = 0;
  for (const double way : {1.0, -1.0}) {
    for (double y_m = -0.004; y_m <= 0.004; y_m += 0.1e-3) {
      const Penetration found = meshPenetration(field, {0, way * y_m, 0}, kRadius_m, kLetsGo_m, side);
      side = found.side;
      const double to_nearer_m = 0.005 - std::abs(y_m);
      EXPECT_NEAR(found.depth_m, kRadius_m - to_nearer_m, 0.3e-3) << way << " " << y_m;
    }
  }
}

TEST(MeshContact, AParticleDeepInASolidIsPushedOutTheWayItCame) {
  const DistanceField field = fieldOf(boxOf({0.06, 0.06, 0.06}));
  int side = 0;
  for (double z_m = -0.036; z_m < -0.005; z_m += 0.5e-3) {
    const Penetration found = meshPenetration(field, {0.002, 0.001, z_m}, kRadius_m, kLetsGo_m, side);
    side = found.side;
    EXPECT_LT(found.outward.z(), -0.9) << z_m;
    EXPECT_GT(found.depth_m, std::min(0.015, 0.0369 + z_m) - 0.1e-3) << z_m;
  }
}

TEST(MeshContact, AParticleGoesRoundTheRimOfAThinWall) {
  const DistanceField field = fieldOf(boxOf({0.06, 0.06, 1e-3}));
  int side = 0;
  // From above, over the rim at x = 30 mm, to below, its surface always 2 mm inside.
  const double way = kRadius_m - 2e-3;
  for (double angle = 90; angle >= -90; angle -= 2) {
    const double radians = angle * std::numbers::pi / 180;
    const Vec3 centre(0.03 + way * std::cos(radians), 0, way * std::sin(radians));
    const Penetration found = meshPenetration(field, centre, kRadius_m, kLetsGo_m, side);
    side = found.side;
    EXPECT_NEAR(found.depth_m, 2e-3, 0.7e-3) << angle;
    EXPECT_GT(found.outward.dot((centre - Vec3(0.03, 0, 0)).normalized()), 0.95) << angle;
  }
}

TEST(MeshContact, ParticlesStayInATubeAndOutsideIt) {
  ToolParameters tube;
  tube.shape = ToolShape::kTube;
  tube.diameter_m = 0.04;
  tube.thickness_m = 1e-3;
  tube.length_m = 0.05;
  const DistanceField field = fieldOf(tube);
  for (const bool inside : {true, false}) {
    int side = 0;
    const double start = inside ? 0.013 : 0.0275, end = inside ? 0.024 : 0.016;
    const double step = inside ? 0.2e-3 : -0.2e-3;
    for (int i = 0; i * std::abs(step) < std::abs(end - start); ++i) {
      const double from_axis = start + i * step;
      const Penetration found = meshPenetration(field, {0, from_axis, 0.004}, kRadius_m, kLetsGo_m, side);
      side = found.side;
      const double exact = inside ? from_axis - (0.02 - 0.5e-3 - kRadius_m) : 0.02 + 0.5e-3 + kRadius_m - from_axis;
      if (exact > 0.5e-3) {
        EXPECT_NEAR(found.depth_m, exact, 0.2e-3) << inside << " " << from_axis;
        EXPECT_GT(found.outward.y() * (inside ? -1 : 1), 0.98) << inside << " " << from_axis;
      }
    }
  }
}

}  // namespace
}  // namespace haptolith
