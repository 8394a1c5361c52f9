#include "haptolith/bed/neighbourhood.h"

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

#include "haptolith/bed/kernel/simd_target.h"

namespace haptolith {
namespace {

constexpr double kReach_m = 0.0189;  // 2 R_attr plus half a radius, for R = 7 mm

std::vector<Float4> padded(std::vector<Float4> positions) {
  positions.resize(paddedCount(positions.size()), kGhost);
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
  return positions;
}

double squaredDistance(const Float4& a, const Float4& b) {
  const double dx = double{a.x} - b.x;
  const double dy = double{a.y} - b.y;
  const double dz = double{a.z} - b.z;
  return dx * dx + dy * dy + dz * dz;
}

/// A crowd in a box, and its lists.
struct Listed {
  std::vector<Float4> reference_position;
  ContactLists lists;
  Neighbourhood neighbourhood;

  Listed(const std::vector<Float4>& positions, const GridBox& box, double largest_excess_m = 0)
      : reference_position(padded(positions)),
        lists(positions.size(), true),
        neighbourhood(positions.size(), {.reach_m = kReach_m, .largest_excess_m = largest_excess_m}, box) {}

  [[nodiscard]] std::size_t particles() const { return lists.particles(); }
  [[nodiscard]] bool buildAll() {
    lists.clear();
    return neighbourhood.buildAll(reference_position, lists);
  }
  [[nodiscard]] std::vector<std::int32_t> neighboursOf(std::size_t i) const {
    std::vector<std::int32_t> names;
    for (std::uint32_t s = 0; s < lists.count(i); ++s) {
      names.push_back(lists.neighbour(i, s));
    }
    return names;
  }
};

/// Compares lists with all pairs of their places: each near pair from both sides, none twice, none beyond the reach.
void expectAllPairs(const Listed& listed, const Periods& periods = {}) {
  const std::size_t n = listed.particles();
  const std::vector<Float4>& at = listed.reference_position;
  for (std::size_t i = 0; i < n; ++i) {
    std::set<std::int32_t> named;
    for (const std::int32_t j : listed.neighboursOf(i)) {
      EXPECT_TRUE(named.insert(j).second) << j << " is listed twice for " << i;
    }
    std::set<std::int32_t> near;
    for (std::size_t j = 0; j < n; ++j) {
      Float4 other = at[j];
      other.x += periods.width * std::round((at[i].x - other.x) * periods.per_width);
      other.y += periods.length * std::round((at[i].y - other.y) * periods.per_length);
      const double distance = std::sqrt(squaredDistance(at[i], other));
      const double reach = kReach_m + at[i].w + at[j].w;
      // Within float's rounding of the reach (relative 1e-6) either answer is right.
      if (std::abs(distance - reach) < 1e-6 * reach) {
        named.erase(static_cast<std::int32_t>(j));
      } else if (i != j && distance < reach) {
        near.insert(static_cast<std::int32_t>(j));
      }
    }
    ASSERT_EQ(named, near) << "particle " << i;
    // The rows of a group end with its longest list, and what a list leaves of them is the ghost.
    const std::size_t group = i / kGroup;
    for (std::size_t row = listed.lists.count(i); row < listed.lists.rowCounts()[group]; ++row) {
      ASSERT_EQ(listed.lists.neighbour(i, static_cast<std::uint32_t>(row)), static_cast<std::int32_t>(n));
    }
  }
}

void expectAllPairs(const std::vector<Float4>& position, double width_m, double length_m) {
  double highest = 0;
  for (const Float4& p : position) {
    highest = std::max<double>(highest, p.z);
  }
  Listed listed(position, {width_m, length_m, std::min(highest, 1.0), {}});
  ASSERT_TRUE(listed.buildAll());
  expectAllPairs(listed);
}

TEST(Neighbourhood, FindsEveryPairThatBruteForceFinds) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    expectAllPairs(randomPositions(300, -0.063F, 0.063F, 0.08F, seed), 0.126, 0.126);
  }
}

TEST(Neighbourhood, FindsThemWithEveryInstructionSet) {
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
    hwy::SetSupportedTargetsForTest(targets & -targets);
    SCOPED_TRACE(simdTarget());
    expectAllPairs(randomPositions(300, -0.063F, 0.063F, 0.08F, 5), 0.126, 0.126);
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST(Neighbourhood, FindsPairsOutsideTheBoxBelowItAndHighAbove) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    expectAllPairs(randomPositions(400, -0.12F, 0.12F, 0.15F, seed), 0.126, 0.126);  // half of them outside
  }
  std::vector<Float4> high = randomPositions(100, -0.03F, 0.03F, 0.03F, 3);
  for (Float4& p : high) {
    p.z += 50;  // far above the last cell
  }
  expectAllPairs(high, 0.126, 0.126);
}

TEST(Neighbourhood, FindsPairsInBoxesOfAnyShape) {
  expectAllPairs(randomPositions(200, -0.05F, 0.05F, 0.05F, 1), 0.014, 0.014);  // one cell sideways, all outside it
  expectAllPairs(randomPositions(200, -0.05F, 0.05F, 0.05F, 2), 5.0, 0.02);     // long and thin
  expectAllPairs(randomPositions(200, -0.05F, 0.05F, 0.05F, 3), 100, 100);      // many more cells than particles
  expectAllPairs(randomPositions(17, -0.01F, 0.01F, 0.01F, 4), 0.126, 0.126);
}

TEST(Neighbourhood, FindsPairsAcrossCellBorders) {
  // Particles exactly one reach apart along the borders between cells, and just inside of that.
  std::vector<Float4> line;
  for (int i = 0; i < 12; ++i) {
    line.push_back({static_cast<float>(-0.063 + i * kReach_m * 0.9999), -0.063F, 0, 0});
    line.push_back({static_cast<float>(-0.063 + i * kReach_m * 1.0001), 0.01F, static_cast<float>(kReach_m), 0});
    line.push_back({static_cast<float>(-0.063 + i * kReach_m), 0.05F, static_cast<float>(2 * kReach_m), 0});
  }
  expectAllPairs(line, 0.126, 0.126);
}

TEST(Neighbourhood, OneParticleHasNoNeighbourAndNoneIsNoTrouble) {
  expectAllPairs({{0, 0, 0.007F, 0}}, 0.126, 0.126);
  expectAllPairs({}, 0.126, 0.126);
}

TEST(Neighbourhood, ASmallBedMayCollapseIntoOnePoint) {
  for (const int n : {2, 15, 16, 17, 32, 33, 64, 80}) {
    SCOPED_TRACE(n);
    expectAllPairs(std::vector<Float4>(static_cast<std::size_t>(n), {0.01F, 0.01F, 0.01F, 0}), 0.126, 0.126);
  }
}

TEST(Neighbourhood, RefusesALargeBedThatHasCollapsed) {
  Listed heap(std::vector<Float4>(1000, {0, 0, 0.01F, 0}), {0.126, 0.126, 0.15, {}});
  EXPECT_FALSE(heap.buildAll());
  // And is as good as new when the particles have come apart again.
  heap.reference_position = padded(randomPositions(1000, -0.063F, 0.063F, 0.15F, 1));
  ASSERT_TRUE(heap.buildAll());
  expectAllPairs(heap);
}

/// Particles in random flight, relisted as in a bed: those further than `threshold_m` from their reference position.
struct Flying {
  std::vector<Float4> position, velocity;
  double bounce_m = 0.1;

  Flying(int particles, double speed_m_s, double excess_m, std::uint64_t seed)
      : position(randomPositions(particles, -0.063F, 0.063F, 0.1F, seed)) {
    std::mt19937_64 random(seed + 1);
    std::normal_distribution<float> any(0, static_cast<float>(speed_m_s));
    std::uniform_real_distribution<float> size(static_cast<float>(-excess_m), static_cast<float>(excess_m));
    for (Float4& p : position) {
      p.w = size(random);
      velocity.push_back({any(random), any(random), any(random), 0});
    }
  }
  void step(double dt) {
    for (std::size_t i = 0; i < position.size(); ++i) {
      const auto move = [dt, this](float& x, float& v) {
        x += static_cast<float>(dt) * v;
        v = std::abs(x) > bounce_m && x * v > 0 ? -v : v;
      };
      move(position[i].x, velocity[i].x);
      move(position[i].y, velocity[i].y);
      move(position[i].z, velocity[i].z);
    }
  }
  [[nodiscard]] std::vector<std::int32_t> away(const Listed& listed, double threshold_m) const {
    std::vector<std::int32_t> away;
    for (std::size_t i = 0; i < position.size(); ++i) {
      if (squaredDistance(position[i], listed.reference_position[i]) > threshold_m * threshold_m) {
        away.push_back(static_cast<std::int32_t>(i));
      }
    }
    return away;
  }
};

TEST(Neighbourhood, IsRightAfterEveryStepOfAViolentScene) {
  // Some move a cell and more in a step, some stand still; half of the room is outside the box.
  for (const double speed : {0.3, 3.0, 30.0}) {
    SCOPED_TRACE(speed);
    constexpr double kExcess_m = 0.001;
    Flying flying(400, speed, kExcess_m, 7);
    Listed listed(flying.position, {0.126, 0.126, 0.1, {}}, kExcess_m);
    ASSERT_TRUE(listed.buildAll());
    std::size_t entered = 0;
    for (int step = 0; step < 200; ++step) {
      flying.step(1e-3);
      const std::vector<std::int32_t> away = flying.away(listed, 0.0017);
      entered += away.size();
      ASSERT_TRUE(listed.neighbourhood.rebuild(away, padded(flying.position), listed.reference_position, listed.lists));
      expectAllPairs(listed);
      if (HasFatalFailure()) {
        return;
      }
    }
    EXPECT_GT(entered, 2000U);
  }
}

TEST(Neighbourhood, IsRightAcrossTheSeamsOfAPeriodicBox) {
  const Periods periods{0.08F, 0.1F, 1 / 0.08F, 1 / 0.1F};
  Flying flying(200, 1, 0, 9);
  Listed listed(flying.position, {0.08, 0.1, 0.1, periods});
  ASSERT_TRUE(listed.buildAll());
  expectAllPairs(listed, periods);
  for (int step = 0; step < 100; ++step) {
    flying.step(1e-3);
    ASSERT_TRUE(listed.neighbourhood.rebuild(flying.away(listed, 0.0017), padded(flying.position),
                                             listed.reference_position, listed.lists));
    expectAllPairs(listed, periods);
    if (HasFatalFailure()) {
      return;
    }
  }
}

TEST(Neighbourhood, MemoryStaysWithItsPair) {
  Flying flying(400, 1, 0, 11);
  Listed listed(flying.position, {0.126, 0.126, 0.1, {}});
  ASSERT_TRUE(listed.buildAll());
  // Every pair stores a different number; pairs that separate and touch again have lost it.
  const auto number = [](std::size_t i, std::size_t j) { return static_cast<float>(1000 * i + j); };
  std::set<std::pair<std::size_t, std::size_t>> known;
  for (std::size_t i = 0; i < listed.particles(); ++i) {
    for (std::uint32_t s = 0; s < listed.lists.count(i); ++s) {
      const auto j = static_cast<std::size_t>(listed.lists.neighbour(i, s));
      listed.lists.setSlip(i, s, {number(i, j), -number(i, j), 2 * number(i, j)});
      known.insert({i, j});
    }
  }
  std::size_t kept = 0, parted = 0;
  for (int step = 0; step < 30; ++step) {
    flying.step(1e-3);
    ASSERT_TRUE(listed.neighbourhood.rebuild(flying.away(listed, 0.0017), padded(flying.position),
                                             listed.reference_position, listed.lists));
    std::set<std::pair<std::size_t, std::size_t>> still;
    for (std::size_t i = 0; i < listed.particles(); ++i) {
      for (std::uint32_t s = 0; s < listed.lists.count(i); ++s) {
        const auto j = static_cast<std::size_t>(listed.lists.neighbour(i, s));
        const Slip slip = listed.lists.slip(i, s);
        const float expected = known.contains({i, j}) ? number(i, j) : 0;
        ASSERT_EQ(slip.x, expected);
        ASSERT_EQ(slip.y, -expected);
        ASSERT_EQ(slip.z, 2 * expected);
        if (expected != 0) {
          still.insert({i, j});
        }
      }
    }
    parted += known.size() - still.size();
    kept += still.size();
    known = still;
  }
  EXPECT_GT(parted, 1000U);
  EXPECT_GT(kept, 1000U);
}

TEST(Neighbourhood, TheOrderOfListsDoesNotDependOnTheHistoryOfCells) {
  // A saved bed has lists, but no cells: rebuilt, it must continue identically.
  Flying flying(300, 1, 0, 13);
  Listed one(flying.position, {0.126, 0.126, 0.1, {}});
  ASSERT_TRUE(one.buildAll());
  const auto step = [&](Listed& listed, int steps, Flying& crowd) {
    for (int i = 0; i < steps; ++i) {
      crowd.step(1e-3);
      ASSERT_TRUE(listed.neighbourhood.rebuild(crowd.away(listed, 0.0017), padded(crowd.position),
                                               listed.reference_position, listed.lists));
    }
  };
  step(one, 50, flying);
  Listed two(flying.position, {0.126, 0.126, 0.1, {}});
  two.reference_position = one.reference_position;
  ASSERT_TRUE(two.buildAll());  // the cells
  two.lists.takeOver(one.lists);
  Flying again = flying;
  step(one, 50, flying);
  step(two, 50, again);
  for (std::size_t i = 0; i < one.particles(); ++i) {
    ASSERT_EQ(one.neighboursOf(i), two.neighboursOf(i));
  }
}

TEST(Neighbourhood, AParticleFarOutsideOrOfAbsurdSizeDoesNotListTheGhost) {
  for (const Float4& odd : {kGhost, Float4{0.1F, 0.1F, 0.1F, 1e10F}}) {
    Listed listed({odd, {0.02F, 0.02F, 0.02F, 0}}, {.width_m = 0.2, .length_m = 0.2, .height_m = 0.2, .periods = {}});
    ASSERT_TRUE(listed.buildAll());
    for (std::size_t i = 0; i < 2; ++i) {
      for (std::uint32_t s = 0; s < listed.lists.count(i); ++s) {
        EXPECT_LT(listed.lists.neighbour(i, s), 2) << i;
      }
    }
  }
}

TEST(ContactLists, AParticleThatIsNotListedIsFoundNowhereAndADebugBuildAborts) {
  ContactLists lists(40, true);
  ASSERT_TRUE(lists.add(3, 7));
  ASSERT_TRUE(lists.add(3, 8));
  EXPECT_EQ(lists.find(3, 8), 1U);
  EXPECT_DEBUG_DEATH(
      {
        EXPECT_EQ(lists.find(3, 9), 2U) << "behind its last";
        EXPECT_EQ(lists.find(4, 3), 0U);
        lists.removeNeighbour(3, 9);
        lists.removeNeighbour(4, 3);
      },
      "not true: s < count");
  EXPECT_EQ(lists.count(3), 2U);
  EXPECT_EQ(lists.count(4), 0U);
  EXPECT_EQ(lists.neighbour(3, 0), 7);
}

TEST(ContactLists, AGroupThatOutgrowsItsRoomKeepsWhatItHas) {
  ContactLists lists(40, true);
  for (std::int32_t j = 0; j < 90; ++j) {
    for (const std::size_t i : {std::size_t{3}, std::size_t{17}, std::size_t{39}}) {
      ASSERT_TRUE(lists.add(i, j));
      lists.setSlip(i, static_cast<std::uint32_t>(j), {static_cast<float>(j), static_cast<float>(i), 1});
    }
  }
  for (const std::size_t i : {std::size_t{3}, std::size_t{17}, std::size_t{39}}) {
    ASSERT_EQ(lists.count(i), 90U);
    for (std::uint32_t s = 0; s < 90; ++s) {
      EXPECT_EQ(lists.neighbour(i, s), static_cast<std::int32_t>(s));
      EXPECT_EQ(lists.slip(i, s).x, static_cast<float>(s));
      EXPECT_EQ(lists.slip(i, s).y, static_cast<float>(i));
    }
  }
  EXPECT_EQ(lists.count(4), 0U);
  EXPECT_EQ(lists.neighbour(4, 50), 40) << "the ghost";
  for (std::int32_t j = 90; j < 96; ++j) {
    ASSERT_TRUE(lists.add(3, j));
  }
  EXPECT_FALSE(lists.add(3, 96));
}

}  // namespace
}  // namespace haptolith
