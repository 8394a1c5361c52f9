#include "haptolith/lab/apparatus/heap_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kRadius = 7e-3;
constexpr double kFoot = 0.5;  // m, radius of the cones on the floor

bool isInCone(const Vec3& point, double angle_rad, double foot_m = kFoot) {
  return point.z() >= 0 && point.z() <= (foot_m - std::hypot(point.x(), point.y())) * std::tan(angle_rad);
}

/// A cone filled with centres that are spread at random, as many as would fill it loosely.
std::vector<Vec3> randomCone(double angle_rad, unsigned seed, double foot_m = kFoot) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> side(-foot_m, foot_m);
  std::uniform_real_distribution<double> up(0, foot_m * std::tan(angle_rad));
  const double volume = 4 * foot_m * foot_m * up.max();
  const auto tries = int(0.6 * volume / (4.0 / 3 * std::numbers::pi * std::pow(kRadius, 3)));
  std::vector<Vec3> centres;
  for (int i = 0; i < tries; ++i) {
    const Vec3 centre(side(random), side(random), up(random));
    if (isInCone(centre, angle_rad, foot_m)) {
      centres.push_back(centre);
    }
  }
  return centres;
}

/// A cone cut out of a close packing: layers of triangles, each over the gaps of the one below.
std::vector<Vec3> packedCone(double angle_rad) {
  std::vector<Vec3> centres;
  const double row = std::sqrt(3.0) * kRadius;
  const double layer = 2 * std::sqrt(2.0 / 3) * kRadius;
  for (int k = 0; k * layer < kFoot * std::tan(angle_rad); ++k) {
    for (int j = -60; j <= 60; ++j) {
      for (int i = -60; i <= 60; ++i) {
        const double shift = k % 2 == 0 ? 0 : 1;
        const Vec3 centre((2 * i + std::abs(j % 2) + shift) * kRadius, (j + shift / 3) * row, k * layer);
        if (isInCone(centre, angle_rad)) {
          centres.push_back(centre);
        }
      }
    }
  }
  return centres;
}

TEST(HeapProfile, OfARandomConeHasTheConesAngle) {
  for (const double angle : {25.0, 35.0, 45.0}) {
    for (const unsigned seed : {1U, 2U, 3U}) {
      const HeapProfile profile = heapProfile(randomCone(angle * kDegree, seed), {.radius_m = kRadius});
      EXPECT_NEAR(profile.angle_of_repose_rad / kDegree, angle, 1) << seed;
      EXPECT_LT(profile.angle_se_rad, 1 * kDegree);
      EXPECT_GT(profile.angle_se_rad, 0);
    }
  }
}

TEST(HeapProfile, OfAPackedConeHasTheConesAngle) {
  for (const double angle : {25.0, 35.0, 45.0}) {
    const HeapProfile profile = heapProfile(packedCone(angle * kDegree), {.radius_m = kRadius});
    EXPECT_NEAR(profile.angle_of_repose_rad / kDegree, angle, 1);
  }
}

TEST(HeapProfile, OfAFewThousandParticlesIsAsNearAsItsStandardErrorSays) {
  constexpr double kSmallFoot = 0.19;  // m; 27 radii
  double squares = 0;
  double variance = 0;
  constexpr int kHeaps = 100;
  for (unsigned seed = 0; seed < kHeaps; ++seed) {
    const std::vector<Vec3> centres = randomCone(35 * kDegree, seed, kSmallFoot);
    ASSERT_LT(centres.size(), 3000U);
    const HeapProfile profile = heapProfile(centres, {.radius_m = kRadius});
    EXPECT_NEAR(profile.angle_of_repose_rad / kDegree, 35, 4) << seed;
    squares += std::pow(profile.angle_of_repose_rad - 35 * kDegree, 2);
    variance += std::pow(profile.angle_se_rad, 2);
  }
  EXPECT_LT(std::sqrt(squares / kHeaps), 1.5 * kDegree);
  EXPECT_NEAR(variance / squares, 1, 0.6);
}

TEST(HeapProfile, FollowsTheHeapWhereverItStands) {
  const Vec3 place(3, -2, 0.7);
  std::vector<Vec3> centres = packedCone(35 * kDegree);
  const HeapProfile here = heapProfile(centres, {.radius_m = kRadius});
  for (Vec3& centre : centres) {
    centre += place;
  }
  const HeapProfile there =
      heapProfile(centres, {.radius_m = kRadius, .axis_x_m = place.x(), .axis_y_m = place.y(), .floor_z_m = place.z()});
  EXPECT_NEAR(there.angle_of_repose_rad, here.angle_of_repose_rad, 0.3 * kDegree);  // ties at the rings' edges may turn
  EXPECT_NEAR(there.height_m, here.height_m, kRadius);
}

TEST(HeapProfile, HardlyDependsOnTheRings) {
  const std::vector<Vec3> centres = randomCone(35 * kDegree, 4);
  for (const double rings : {3.0, 6.0, 8.0}) {
    const HeapProfile profile = heapProfile(centres, {.radius_m = kRadius, .ring_width_m = rings * kRadius});
    EXPECT_NEAR(profile.angle_of_repose_rad / kDegree, 35, 1.5) << rings;
  }
}

TEST(HeapProfile, IsNotTurnedByABluntTipAndStrayParticles) {
  std::vector<Vec3> centres = randomCone(30 * kDegree, 5);
  const double blunt = 0.85 * kFoot * std::tan(30 * kDegree);
  std::erase_if(centres, [&](const Vec3& centre) { return centre.z() > blunt; });
  for (int i = 0; i < 200; ++i) {
    centres.emplace_back((kFoot + 0.002 * i) * std::cos(i), (kFoot + 0.002 * i) * std::sin(i), kRadius);
  }
  EXPECT_NEAR(heapProfile(centres, {.radius_m = kRadius}).angle_of_repose_rad / kDegree, 30, 1.5);
}

TEST(HeapProfile, TheFlankIsTheMiddleOfTheHeight) {
  const HeapProfile profile = heapProfile(packedCone(35 * kDegree), {.radius_m = kRadius});
  ASSERT_GE(profile.flank.size(), 3U);
  ASSERT_GT(profile.rings.size(), profile.flank.size());
  for (const HeapRing& ring : profile.flank) {
    EXPECT_GE(ring.height_m, 0.2 * profile.height_m);
    EXPECT_LT(ring.height_m, 0.8 * profile.height_m);
    EXPECT_NEAR(profile.line.at(ring.radius_m), ring.height_m, 2 * kRadius);
  }
}

TEST(HeapProfile, RefusesNonsenseAndHeapsWithoutAFlank) {
  std::vector<Vec3> centres = packedCone(35 * kDegree);
  EXPECT_THROW(static_cast<void>(heapProfile(centres, {})), InvalidParameter);
  EXPECT_THROW(static_cast<void>(heapProfile(centres, {.radius_m = kRadius, .ring_width_m = -1})), InvalidParameter);
  EXPECT_THROW(static_cast<void>(heapProfile({}, {.radius_m = kRadius})), Failure);
  const std::vector<Vec3> one{Vec3(0, 0, kRadius)};
  EXPECT_THROW(static_cast<void>(heapProfile(one, {.radius_m = kRadius})), Failure);
  std::vector<Vec3> flat;
  for (const Vec3& centre : centres) {
    flat.emplace_back(centre.x(), centre.y(), kRadius);
  }
  EXPECT_THROW(static_cast<void>(heapProfile(flat, {.radius_m = kRadius})), Failure);
  centres.front().x() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(static_cast<void>(heapProfile(centres, {.radius_m = kRadius})), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
