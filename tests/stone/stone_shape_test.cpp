#include "haptolith/stone/stone_shape.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "stones.h"

namespace haptolith {
namespace {

using testing::HasSubstr;

double ballVolume(double radius_m) {
  return 4.0 / 3 * std::numbers::pi * std::pow(radius_m, 3);
}

/// Four whose centres lie in no plane, so that all three moments differ.
std::vector<StoneSphere> someSpheres() {
  return {{.centre_m = {1, 2, 3}, .radius_m = 0.5},
          {.centre_m = {1.6, 2.2, 3.1}, .radius_m = 0.3},
          {.centre_m = {0.8, 2.6, 3.2}, .radius_m = 0.2},
          {.centre_m = {1.9, 2.3, 2.9}, .radius_m = 0.2}};
}

TEST(StoneShape, OfOneSphereIsExact) {
  const StoneShape stone = makeStoneShape({{.centre_m = {3, -4, 5}, .radius_m = 0.2}});
  ASSERT_EQ(stone.spheres.size(), 1U);
  EXPECT_EQ(stone.spheres[0], (StoneSphere{.centre_m = Vec3::Zero(), .radius_m = 0.2}));
  EXPECT_DOUBLE_EQ(stone.volume_m3, ballVolume(0.2));
  for (const double moment_m5 : stone.inertia_m5) {
    EXPECT_DOUBLE_EQ(moment_m5, 0.4 * ballVolume(0.2) * 0.2 * 0.2);
  }
  EXPECT_DOUBLE_EQ(stone.reach_m, 0.2);
  EXPECT_DOUBLE_EQ(stone.radius(), 0.2);
}

TEST(StoneShape, RoundStoneIsAsLargeAsAsked) {
  const StoneShape stone = roundStone(0.06);
  EXPECT_DOUBLE_EQ(stone.radius(), 0.03);
  EXPECT_TRUE(stone.shown.triangles.empty());
}

TEST(StoneShape, OfTwoSpheresIsLessTheirLens) {
  const double large_m = 1;
  const double small_m = 0.7;
  const Vec3 between_m(0.3, 1, 0.2);
  const double d_m = between_m.norm();
  const double lens_m3 = std::numbers::pi * std::pow(large_m + small_m - d_m, 2) *
                         (d_m * d_m + 2 * d_m * (large_m + small_m) - 3 * std::pow(large_m - small_m, 2)) / (12 * d_m);
  const double exact_m3 = ballVolume(large_m) + ballVolume(small_m) - lens_m3;
  const StoneShape stone =
      makeStoneShape({{.centre_m = Vec3::Zero(), .radius_m = large_m}, {.centre_m = between_m, .radius_m = small_m}});
  EXPECT_NEAR(stone.volume_m3, exact_m3, 3e-4 * exact_m3);
  EXPECT_NEAR(stone.inertia_m5.y(), stone.inertia_m5.z(), 1e-3 * stone.inertia_m5.z());
  // Both lie on the axis of the smallest moment, as far apart as before.
  const Vec3 apart_m = stone.spheres[1].centre_m - stone.spheres[0].centre_m;
  EXPECT_NEAR(std::abs(apart_m.x()), d_m, 1e-4);
  made::expectPrincipalFrame(stone, 0.01);
}

TEST(StoneShape, OfASphereWithinASphereIsTheOuterOne) {
  const StoneShape stone =
      makeStoneShape({{.centre_m = {0, 0, 0}, .radius_m = 0.01}, {.centre_m = {0.002, 0, 0}, .radius_m = 0.002}});
  EXPECT_NEAR(stone.volume_m3, ballVolume(0.01), 3e-4 * ballVolume(0.01));
  EXPECT_NEAR(stone.reach_m, 0.01, 1e-5);
}

TEST(StoneShape, LiesInThePrincipalFrame) {
  const StoneShape stone = makeStoneShape(someSpheres());
  made::expectPrincipalFrame(stone, 0.01);
  EXPECT_LT(stone.inertia_m5.x(), stone.inertia_m5.y());
  EXPECT_LT(stone.inertia_m5.y(), stone.inertia_m5.z());
  double reach_m = 0;
  for (const StoneSphere& sphere : stone.spheres) {
    reach_m = std::max(reach_m, sphere.centre_m.norm() + sphere.radius_m);
  }
  EXPECT_DOUBLE_EQ(stone.reach_m, reach_m);
}

TEST(StoneShape, IsMovedButNotMirrored) {
  const std::vector<StoneSphere> before = someSpheres();
  const std::vector<StoneSphere> after = makeStoneShape(before).spheres;
  const auto six_volumes_m3 = [](const std::vector<StoneSphere>& s) {
    const Vec3 a = s[1].centre_m - s[0].centre_m;
    const Vec3 b = s[2].centre_m - s[0].centre_m;
    return a.dot(b.cross(s[3].centre_m - s[0].centre_m));
  };
  EXPECT_GT(std::abs(six_volumes_m3(before)), 1e-3);
  EXPECT_NEAR(six_volumes_m3(after), six_volumes_m3(before), 1e-12);
  for (std::size_t i = 1; i < before.size(); ++i) {
    EXPECT_NEAR((after[i].centre_m - after[0].centre_m).norm(), (before[i].centre_m - before[0].centre_m).norm(),
                1e-12);
    EXPECT_EQ(after[i].radius_m, before[i].radius_m);
  }
}

TEST(StoneShape, StaysWhereItIsOnceItLiesInItsFrame) {
  const StoneShape stone = makeStoneShape(someSpheres());
  const StoneShape again = makeStoneShape(stone.spheres);
  for (std::size_t i = 0; i < stone.spheres.size(); ++i) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(std::abs(again.spheres[i].centre_m[axis]), std::abs(stone.spheres[i].centre_m[axis]), 1e-3);
    }
  }
}

TEST(StoneShape, TakesWhatIsShownAlong) {
  TriangleMesh shown;
  for (const StoneSphere& sphere : someSpheres()) {
    shown.points_m.push_back(sphere.centre_m);
  }
  const StoneShape stone = makeStoneShape(someSpheres(), shown);
  for (std::size_t i = 0; i < stone.spheres.size(); ++i) {
    EXPECT_LT((stone.shown.points_m[i] - stone.spheres[i].centre_m).norm(), 1e-12);
  }
}

TEST(StoneShape, RefusesWhatIsNoStone) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto refusal_of = [](const std::vector<StoneSphere>& spheres) {
    return made::refusalOf([&] { (void)makeStoneShape(spheres); });
  };
  const StoneSphere sphere{.centre_m = Vec3::Zero(), .radius_m = 1};
  EXPECT_EQ(refusal_of({}), "spheres = 0 is not valid: must be 1 to 500");
  EXPECT_THAT(refusal_of(std::vector<StoneSphere>(501, sphere)), HasSubstr("spheres = 501 is not valid"));
  EXPECT_EQ(refusal_of({sphere, {.centre_m = Vec3::Zero(), .radius_m = 0}}), "radius_m = 0 is not valid: must be > 0");
  EXPECT_THAT(refusal_of({{.centre_m = Vec3::Zero(), .radius_m = kInfinity}}), HasSubstr("radius_m = inf"));
  EXPECT_THAT(refusal_of({{.centre_m = {0, std::nan(""), 0}, .radius_m = 1}}), HasSubstr("centre_m = nan"));
  EXPECT_EQ(refusal_of({sphere, {.centre_m = {1, 0, 0}, .radius_m = 1}, {.centre_m = {4, 0, 0}, .radius_m = 1}}),
            "spheres = 2 that hold together of 3 is not valid: must be spheres that all hold together: each overlaps "
            "another");
}

TEST(StoneShape, RoundStoneRefusesSizesOutOfRange) {
  EXPECT_EQ(made::refusalOf([] { (void)roundStone(11); }), "size_m = 11 is not valid: must be 0.001 to 10");
  EXPECT_THAT(made::refusalOf([] { (void)roundStone(std::nan("")); }), HasSubstr("size_m = nan"));
}

}  // namespace
}  // namespace haptolith
