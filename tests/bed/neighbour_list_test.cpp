#include "haptolith/bed/neighbour_list.h"

#include <gtest/gtest.h>
#include <hwy/detect_targets.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "haptolith/bed/contact_kernel.h"

namespace haptolith {
namespace {

constexpr double kReach_m = 0.0189;  // 2 R_attr plus half a radius, for R = 7 mm

std::vector<Float4> withGhost(std::vector<Float4> positions) {
  positions.push_back({1e9F, 1e9F, 1e9F, 0});
  return positions;
}

std::vector<Float4> randomPositions(int particles, float low, float high, float top, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> sideways(low, high);
  std::uniform_real_distribution<float> up(low, top);
  std::vector<Float4> positions;
  for (int i = 0; i < particles; ++i) {
    positions.push_back({sideways(random), sideways(random), up(random), 0});
  }
  return withGhost(positions);
}

double squaredDistance(const Float4& a, const Float4& b) {
  const double dx = double{a.x} - b.x;
  const double dy = double{a.y} - b.y;
  const double dz = double{a.z} - b.z;
  return dx * dx + dy * dy + dz * dz;
}

/// A particle's list as it stands, ghosts included.
std::vector<std::int32_t> neighboursOf(const NeighbourList& list, std::size_t i) {
  return {list.indices() + list.begin(i), list.indices() + list.end(i)};
}

/// Compares a built list with all pairs: each near pair from both sides, none twice, none beyond the reach.
void expectAllPairs(const NeighbourList& list, const std::vector<Float4>& position) {
  const std::size_t n = position.size() - 1;
  for (std::size_t i = 0; i < n; ++i) {
    ASSERT_LE(list.begin(i), list.end(i));
    EXPECT_EQ((list.end(i) - list.begin(i)) % kNeighbourBlock, 0U);
    std::set<std::int32_t> listed;
    bool ghost_seen = false;
    for (std::uint32_t s = list.begin(i); s < list.end(i); ++s) {
      const std::int32_t j = list.indices()[s];
      if (j == static_cast<std::int32_t>(n)) {
        ghost_seen = true;
        continue;
      }
      EXPECT_FALSE(ghost_seen) << "a neighbour of " << i << " after its ghosts";
      EXPECT_TRUE(listed.insert(j).second) << j << " is listed twice for " << i;
    }
    std::set<std::int32_t> near;
    for (std::size_t j = 0; j < n; ++j) {
      const double distance = std::sqrt(squaredDistance(position[i], position[j]));
      // Within float's rounding of the reach (relative 1e-6) either answer is right.
      if (std::abs(distance - kReach_m) < 1e-6 * kReach_m) {
        listed.erase(static_cast<std::int32_t>(j));
      } else if (i != j && distance < kReach_m) {
        near.insert(static_cast<std::int32_t>(j));
      }
    }
    EXPECT_EQ(listed, near) << "particle " << i;
  }
}

void expectAllPairs(const std::vector<Float4>& position, double width_m, double length_m) {
  NeighbourList list(position.size() - 1, kReach_m, width_m, length_m);
  ASSERT_TRUE(list.build(position));
  expectAllPairs(list, position);
}

TEST(NeighbourList, FindsEveryPairThatBruteForceFinds) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    expectAllPairs(randomPositions(300, -0.063F, 0.063F, 0.08F, seed), 0.126, 0.126);
  }
}

TEST(NeighbourList, FindsThemWithEveryInstructionSet) {
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
    hwy::SetSupportedTargetsForTest(targets & -targets);
    SCOPED_TRACE(simdTarget());
    expectAllPairs(randomPositions(300, -0.063F, 0.063F, 0.08F, 5), 0.126, 0.126);
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST(NeighbourList, ListsTheSameOrderWithEveryInstructionSet) {
  const std::vector<Float4> position = randomPositions(200, -0.063F, 0.063F, 0.08F, 6);
  std::vector<std::vector<std::int32_t>> first;
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
    hwy::SetSupportedTargetsForTest(targets & -targets);
    NeighbourList list(200, kReach_m, 0.126, 0.126);
    ASSERT_TRUE(list.build(position));
    std::vector<std::vector<std::int32_t>> listed;
    for (std::size_t i = 0; i < 200; ++i) {
      listed.push_back(neighboursOf(list, i));
    }
    if (first.empty()) {
      first = listed;
    }
    EXPECT_EQ(listed, first) << simdTarget();
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST(NeighbourList, FindsPairsOutsideTheBoxBelowItAndHighAbove) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    expectAllPairs(randomPositions(400, -0.12F, 0.12F, 0.15F, seed), 0.126, 0.126);  // half of them outside
  }
  std::vector<Float4> high = randomPositions(100, -0.03F, 0.03F, 0.03F, 3);
  for (std::size_t i = 0; i + 1 < high.size(); ++i) {
    high[i].z += 50;  // far above the last cell
  }
  expectAllPairs(high, 0.126, 0.126);
}

TEST(NeighbourList, FindsPairsInBoxesOfAnyShape) {
  expectAllPairs(randomPositions(200, -0.05F, 0.05F, 0.05F, 1), 0.014, 0.014);  // one cell sideways, all outside it
  expectAllPairs(randomPositions(200, -0.05F, 0.05F, 0.05F, 2), 5.0, 0.02);     // long and thin
  expectAllPairs(randomPositions(200, -0.05F, 0.05F, 0.05F, 3), 100, 100);      // many more cells than particles
  expectAllPairs(randomPositions(17, -0.01F, 0.01F, 0.01F, 4), 0.126, 0.126);
}

TEST(NeighbourList, FindsPairsAcrossCellBorders) {
  // Particles exactly one reach apart along the borders between cells, and just inside of that.
  std::vector<Float4> line;
  for (int i = 0; i < 12; ++i) {
    line.push_back({static_cast<float>(-0.063 + i * kReach_m * 0.9999), -0.063F, 0, 0});
    line.push_back({static_cast<float>(-0.063 + i * kReach_m * 1.0001), 0.01F, static_cast<float>(kReach_m), 0});
    line.push_back({static_cast<float>(-0.063 + i * kReach_m), 0.05F, static_cast<float>(2 * kReach_m), 0});
  }
  expectAllPairs(withGhost(line), 0.126, 0.126);
}

TEST(NeighbourList, OneParticleHasNoNeighbour) {
  NeighbourList list(1, kReach_m, 0.126, 0.126);
  ASSERT_TRUE(list.build(withGhost({{0, 0, 0.007F, 0}})));
  EXPECT_EQ(list.begin(0), list.end(0));
}

TEST(NeighbourList, NoParticleIsNoTrouble) {
  NeighbourList list(0, kReach_m, 0.126, 0.126);
  EXPECT_TRUE(list.build(withGhost({})));
}

TEST(NeighbourList, ASmallBedMayCollapseIntoOnePoint) {
  // Everybody next to everybody: "room for all pairs of a small bed however it collapses".
  for (const int n : {2, 15, 16, 17, 32, 33, 64, 80}) {
    SCOPED_TRACE(n);
    expectAllPairs(withGhost(std::vector<Float4>(static_cast<std::size_t>(n), {0.01F, 0.01F, 0.01F, 0})), 0.126, 0.126);
  }
}

TEST(NeighbourList, RefusesALargeBedThatHasCollapsed) {
  const std::vector<Float4> heap = withGhost(std::vector<Float4>(1000, {0, 0, 0.01F, 0}));
  NeighbourList list(1000, kReach_m, 0.126, 0.126);
  EXPECT_FALSE(list.build(heap));
  // And is as good as new when the particles have come apart again.
  const std::vector<Float4> apart = randomPositions(1000, -0.063F, 0.063F, 0.15F, 1);
  ASSERT_TRUE(list.build(apart));
  expectAllPairs(list, apart);
}

TEST(NeighbourList, BuildingTwiceGivesTheSameList) {
  const std::vector<Float4> position = randomPositions(300, -0.063F, 0.063F, 0.08F, 9);
  NeighbourList list(300, kReach_m, 0.126, 0.126);
  ASSERT_TRUE(list.build(randomPositions(300, -0.063F, 0.063F, 0.08F, 10)));
  ASSERT_TRUE(list.build(position));
  NeighbourList fresh(300, kReach_m, 0.126, 0.126);
  ASSERT_TRUE(fresh.build(position));
  for (std::size_t i = 0; i < 300; ++i) {  // the order too: it is the order of sums
    EXPECT_EQ(neighboursOf(list, i), neighboursOf(fresh, i));
  }
}

}  // namespace
}  // namespace haptolith
