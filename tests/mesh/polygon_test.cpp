#include "haptolith/mesh/polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "haptolith/core/math/random.h"

namespace haptolith {
namespace {

using Triangles = std::vector<std::array<std::size_t, 3>>;

Triangles cut(const std::vector<Vec3>& corners) {
  PolygonCutter cutter;
  Triangles triangles;
  EXPECT_TRUE(cutter.cut(corners, triangles));
  EXPECT_EQ(triangles.size(), corners.size() - 2);
  return triangles;
}

/// Sum of the areas, and area of the sum: the same where no triangle is turned over.
std::pair<double, double> areas(const std::vector<Vec3>& corners, const Triangles& triangles) {
  double sum = 0;
  Vec3 together = Vec3::Zero();
  for (const auto& [a, b, c] : triangles) {
    const Vec3 normal = (corners[b] - corners[a]).cross(corners[c] - corners[a]) / 2;
    sum += normal.norm();
    together += normal;
  }
  return {sum, together.norm()};
}

TEST(Polygon, WithoutDentsIsAFan) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 7; ++i) {
    corners.emplace_back(std::cos(i), std::sin(i), 0);
  }
  EXPECT_EQ(cut(corners), (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 6}}));
  EXPECT_EQ(cut({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0.2), Vec3(0, 1, 0)}), (Triangles{{0, 1, 2}, {0, 2, 3}}))
      << "bent, without a dent";
  EXPECT_EQ(cut({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(2, 2, 0)}), (Triangles{{0, 1, 2}, {0, 2, 3}}))
      << "a corner that is none";
  EXPECT_EQ(cut({Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}), (Triangles{{0, 1, 2}, {0, 2, 3}}));
}

TEST(Polygon, WithDentsIsCoveredOnce) {
  std::mt19937_64 random(1);
  for (int n = 4; n < 60; ++n) {
    // A star about the origin, in any plane, bent a little out of it.
    const Quat turn = Quat(uniformSigned(random), uniformSigned(random), uniformSigned(random), 1.1).normalized();
    std::vector<Vec3> corners;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      const double out = i % 2 == 0 ? 1 : 0.3 + 0.1 * uniformSigned(random);
      corners.emplace_back(turn * Vec3(out * std::cos(angle), out * std::sin(angle), 0));
    }
    Vec3 area = Vec3::Zero();
    for (int i = 0; i < n; ++i) {
      area += corners[static_cast<std::size_t>(i)].cross(corners[static_cast<std::size_t>((i + 1) % n)]) / 2;
    }
    const Triangles triangles = cut(corners);
    const auto [sum, together] = areas(corners, triangles);
    EXPECT_NEAR(sum, area.norm(), 1e-9) << n;
    EXPECT_NEAR(together, area.norm(), 1e-9) << n;
  }
}

TEST(Polygon, ThatCrossesItselfIsStillCut) {
  EXPECT_EQ(cut({Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.2, 3, 0)}).size(), 3U);
}

TEST(Polygon, ThatWouldTakeMinutesIsRefused) {
  std::vector<Vec3> comb;  // no tooth of it is an ear for long
  for (int i = 0; i < 100'000; ++i) {
    comb.emplace_back(i, i % 2 == 0 ? 0 : 1, 0);
  }
  comb.emplace_back(50'000, 1e6, 0);
  PolygonCutter cutter;
  Triangles triangles;
  EXPECT_FALSE(cutter.cut(comb, triangles));
}

}  // namespace
}  // namespace haptolith
