#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "haptolith/stone/filling.h"
#include "haptolith/stone/stone_shape.h"

#include "made_meshes.h"
#include "stones.h"

namespace haptolith {
namespace {

using testing::HasSubstr;

constexpr double kSize_m = 0.05;

class AngularRock : public testing::TestWithParam<int> {
 protected:
  const StoneShape rock_ = angularRock(kSize_m, static_cast<std::uint64_t>(GetParam()));
};

TEST_P(AngularRock, HasTheVolumeOfItsSize) {
  EXPECT_NEAR(rock_.volume_m3, std::numbers::pi / 6 * std::pow(kSize_m, 3), 1e-12 * kSize_m);
  made::expectPrincipalFrame(rock_, 0.005);
}

TEST_P(AngularRock, ShowsAClosedSurfaceThatLooksOutwards) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> passed;
  for (const auto& triangle : rock_.shown.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      ++passed[{triangle[i], triangle[(i + 1) % 3]}];
    }
    const auto [a, b, c] = cornersOf(rock_.shown, triangle);
    EXPECT_GT(a.dot((b - a).cross(c - a)), 0) << "seen from the middle, all look away";
  }
  for (const auto& [edge, times] : passed) {
    EXPECT_EQ(times, 1);
    EXPECT_TRUE(passed.contains({edge.second, edge.first}));
  }
  EXPECT_GE(rock_.shown.triangles.size(), 20U);
  EXPECT_GT(made::volume_m3(rock_.shown), rock_.volume_m3);
}

TEST_P(AngularRock, IsFilledUpToItsFacesAndNoFarther) {
  for (const auto& triangle : rock_.shown.triangles) {
    const auto [a, b, c] = cornersOf(rock_.shown, triangle);
    const Vec3 normal = (b - a).cross(c - a).normalized();
    for (const StoneSphere& sphere : rock_.spheres) {
      EXPECT_LT(normal.dot(sphere.centre_m - a) + sphere.radius_m, 1e-9);
    }
  }
  std::vector<double> away_m;
  for (const SurfacePoint& at : spreadOver(rock_.shown, 5000)) {
    away_m.push_back(made::distanceToUnion(at.point_m, rock_.spheres));
  }
  std::ranges::sort(away_m);
  EXPECT_LT(away_m[away_m.size() / 2], 0.02 * kSize_m);
  EXPECT_LT(away_m[away_m.size() * 95 / 100], 0.05 * kSize_m);
  EXPECT_GE(rock_.spheres.size(), 20U);
  EXPECT_LE(rock_.spheres.size(), 45U);
}

INSTANTIATE_TEST_SUITE_P(Seeds, AngularRock, testing::Values(1, 2, 3, 17));

TEST(AngularRocks, AreTheSameForTheSameSeedOnly) {
  const StoneShape rock = angularRock(kSize_m, 5);
  const StoneShape again = angularRock(kSize_m, 5);
  EXPECT_EQ(rock.spheres, again.spheres);
  EXPECT_EQ(rock.inertia_m5, again.inertia_m5);
  EXPECT_EQ(rock.shown.points_m, again.shown.points_m);
  EXPECT_NE(rock.spheres, angularRock(kSize_m, 6).spheres);
}

TEST(AngularRocks, AreAllRocks) {
  for (std::uint64_t seed = 100; seed < 130; ++seed) {
    const StoneShape rock = angularRock(kSize_m, seed);
    EXPECT_GE(rock.shown.triangles.size(), 20U) << seed;
    EXPECT_LT(rock.reach_m, 1.2 * kSize_m) << seed;
    EXPECT_GT(rock.inertia_m5.x(), 0.25 * rock.inertia_m5.z()) << seed;
  }
}

TEST(AngularRocks, RefuseSizesOutOfRange) {
  EXPECT_THAT(made::refusalOf([] { (void)angularRock(1e-4, 1); }),
              HasSubstr("size_m = 0.0001 is not valid: must be 0.001 to 10"));
}

}  // namespace
}  // namespace haptolith
