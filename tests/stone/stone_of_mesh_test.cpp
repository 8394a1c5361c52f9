#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <string>

#include "haptolith/core/process/stop_asked.h"
#include "haptolith/mesh/mend.h"
#include "haptolith/stone/stone_shape.h"

#include "made_meshes.h"
#include "stones.h"

namespace haptolith {
namespace {

using testing::HasSubstr;

std::string refusalOf(const MendedMesh& mesh, double size_m = 0.1, std::size_t most_spheres = 60) {
  return made::refusalOf([&] { (void)stoneOfMesh(mesh, size_m, most_spheres); });
}

TEST(StoneOfMesh, OfACubeFillsIt) {
  constexpr double kSize_m = 0.1;
  const StoneShape stone = stoneOfMesh(mend(made::cube(0.02, {1, 2, 3})), kSize_m, 200);
  EXPECT_LE(stone.spheres.size(), 200U);
  EXPECT_NEAR(stone.volume_m3, std::numbers::pi / 6 * std::pow(kSize_m, 3), 1e-12);
  // The spheres leave out what lies in its edges and between them.
  EXPECT_NEAR(made::volume_m3(stone.shown), stone.volume_m3, 0.1 * stone.volume_m3);
  EXPECT_NEAR(stone.inertia_m5.x(), stone.inertia_m5.z(), 0.01 * stone.inertia_m5.z());
  const double edge_m = std::cbrt(stone.volume_m3);
  EXPECT_NEAR(stone.inertia_m5.z(), stone.volume_m3 * edge_m * edge_m / 6, 0.03 * stone.inertia_m5.z());
}

TEST(StoneOfMesh, OfABallIsOneSphere) {
  const StoneShape stone = stoneOfMesh(mend(made::sphere(3, 40)), 0.05);
  ASSERT_EQ(stone.spheres.size(), 1U);
  EXPECT_NEAR(stone.spheres[0].radius_m, 0.025, 1e-12);
}

TEST(StoneOfMesh, ReachesNowhereOutOfIt) {
  const Vec3 half_m(0.02, 0.01, 0.006);
  const StoneShape stone = stoneOfMesh(mend(made::box(-half_m, half_m)), 0.02);
  for (const auto& triangle : stone.shown.triangles) {
    const auto [a, b, c] = cornersOf(stone.shown, triangle);
    const Vec3 normal = (b - a).cross(c - a).normalized();
    for (const StoneSphere& sphere : stone.spheres) {
      EXPECT_LT(normal.dot(sphere.centre_m - a) + sphere.radius_m, 1e-9);
    }
  }
  // The longest side lies along x, the shortest along z.
  const MeshCorners corners = cornersOf(stone.shown);
  const Vec3 sides_m = corners.high_m - corners.low_m;
  EXPECT_NEAR(sides_m.y() / sides_m.x(), half_m.y() / half_m.x(), 0.05);
  EXPECT_NEAR(sides_m.z() / sides_m.x(), half_m.z() / half_m.x(), 0.05);
  EXPECT_LE(stone.spheres.size(), 60U);
}

TEST(StoneOfMesh, PassesFromPartToPart) {
  // Two cubes that pass through each other: a wall between them would keep every sphere in one of them.
  const MendedMesh mended =
      mend(made::together(made::box({0, 0, 0}, {3, 1, 1}), made::box({2, 0.01, 0.01}, {5, 0.99, 0.99})));
  ASSERT_EQ(mended.shell_count, 2);
  const StoneShape stone = stoneOfMesh(mended, 0.1, 100);
  const MeshCorners corners = cornersOf(stone.shown);
  Vec3 low_m = Vec3::Zero();
  Vec3 high_m = Vec3::Zero();
  for (const StoneSphere& sphere : stone.spheres) {
    low_m = low_m.cwiseMin(sphere.centre_m - Vec3::Constant(sphere.radius_m));
    high_m = high_m.cwiseMax(sphere.centre_m + Vec3::Constant(sphere.radius_m));
  }
  EXPECT_NEAR((high_m - low_m).x(), (corners.high_m - corners.low_m).x(), 0.1 * (corners.high_m - corners.low_m).x());
}

TEST(StoneOfMesh, RefusesWhatIsNoStone) {
  const MendedMesh cube = mend(made::cube(0.02));
  EXPECT_EQ(refusalOf(cube, 20), "size_m = 20 is not valid: must be 0.001 to 10");
  EXPECT_EQ(refusalOf(cube, 0.1, 0), "most_spheres = 0 is not valid: must be 1 to 500");
  EXPECT_EQ(refusalOf(cube, 0.1, 501), "most_spheres = 501 is not valid: must be 1 to 500");
  EXPECT_EQ(refusalOf(mend(made::tube(0.02, 0, 0.03, 24), {.sheet_thickness_m = 0.002})),
            "mesh = a sheet of 0.002 m is not valid: must be a closed solid");
  EXPECT_THAT(refusalOf(MendedMesh{}), HasSubstr("must be a closed solid"));
  EXPECT_THAT(refusalOf(mend(made::box({0, 0, 0}, {1, 1, 0.01}))), HasSubstr("so thick that they fill 50 % or more"));
  EXPECT_THAT(refusalOf(mend(made::together(made::cube(1), made::cube(1, {3, 0, 0})))), HasSubstr("must be one piece"));
}

TEST(StoneOfMesh, EndsWhenAsked) {
  const MendedMesh cube = mend(made::cube(0.02));
  stopAsked() = true;
  EXPECT_THROW((void)stoneOfMesh(cube, 0.1), Failure);
  stopAsked() = false;
}

}  // namespace
}  // namespace haptolith
