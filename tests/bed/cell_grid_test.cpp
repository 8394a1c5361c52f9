#include "haptolith/bed/cell_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <vector>

namespace haptolith {
namespace {

constexpr double kCell_m = 0.01;

/// Along one axis, round the nearer way where it repeats itself.
double apart(double a, double b, double period) {
  const double way = std::abs(a - b);
  return period > 0 ? std::abs(way - period * std::round(way / period)) : way;
}

struct Boxed {
  const char* name;
  bool periodic_x, periodic_y;
};

class RandomGrid : public testing::TestWithParam<Boxed> {
 protected:
  static constexpr double kWidth_m = 0.073, kLength_m = 0.042, kHeight_m = 0.03;
  static constexpr std::size_t kParticles = 400;

  RandomGrid() : grid_(kParticles, kCell_m, box()), where_(kParticles), cell_(kParticles) {}

  [[nodiscard]] static GridBox box() {
    GridBox box{kWidth_m, kLength_m, kHeight_m, {}};
    if (GetParam().periodic_x) {
      box.periods.width = static_cast<float>(kWidth_m);
      box.periods.per_width = 1 / box.periods.width;
    }
    if (GetParam().periodic_y) {
      box.periods.length = static_cast<float>(kLength_m);
      box.periods.per_length = 1 / box.periods.length;
    }
    return box;
  }

  /// Also outside of the box, and in heaps of more than a cell has room for.
  [[nodiscard]] Float4 somewhere() {
    const auto in = [this](double low, double high) {
      return static_cast<float>(std::uniform_real_distribution<double>(low, high)(random_));
    };
    if (std::uniform_int_distribution<int>(0, 4)(random_) == 0) {
      return {in(0.012, 0.015), in(0.012, 0.015), in(0.001, 0.004), 0};
    }
    return {in(-0.06, 0.06), in(-0.05, 0.05), in(-0.02, 0.12), 0};
  }
  void put(std::size_t i) {
    where_[i] = somewhere();
    cell_[i] = grid_.cellOf(where_[i]);
    grid_.insert(static_cast<std::int32_t>(i), cell_[i]);
  }

  [[nodiscard]] std::set<std::int32_t> within(const Float4& place, double reach_m) const {
    const Periods periods = box().periods;
    std::set<std::int32_t> found;
    for (std::size_t i = 0; i < kParticles; ++i) {
      const Float4& p = where_[i];
      if (apart(p.x, place.x, periods.width) <= reach_m && apart(p.y, place.y, periods.length) <= reach_m &&
          std::abs(p.z - place.z) <= reach_m) {
        found.insert(static_cast<std::int32_t>(i));
      }
    }
    return found;
  }

  void expectAllOf(const std::set<std::int32_t>& wanted, const std::vector<std::int32_t>& found, const char* what) {
    const std::set<std::int32_t> once(found.begin(), found.end());
    EXPECT_EQ(once.size(), found.size()) << what << ": no particle twice";
    EXPECT_TRUE(std::ranges::includes(once, wanted)) << what << " misses a particle";
  }

  std::mt19937 random_{5};
  CellGrid grid_;
  std::vector<Float4> where_;
  std::vector<std::uint32_t> cell_;
};
INSTANTIATE_TEST_SUITE_P(Boxes, RandomGrid,
                         testing::Values(Boxed{"walls", false, false}, Boxed{"x", true, false}, Boxed{"y", false, true},
                                         Boxed{"both", true, true}),
                         [](const auto& box) { return box.param.name; });

TEST_P(RandomGrid, FindsAllThatIsWithinReach) {
  for (std::size_t i = 0; i < kParticles; ++i) {
    put(i);
  }
  for (int round = 0; round < 20; ++round) {
    for (int moves = 0; moves < 50; ++moves) {
      const std::size_t i = std::uniform_int_distribution<std::size_t>(0, kParticles - 1)(random_);
      grid_.remove(static_cast<std::int32_t>(i), cell_[i]);
      put(i);
    }
    const Float4 place = somewhere();
    std::vector<std::int32_t> found(grid_.candidatesAtMost());
    found.resize(grid_.candidates(grid_.cellOf(place), found.data()));
    expectAllOf(within(place, kCell_m), found, "candidates");

    for (const float reach_m : {0.004F, 0.013F, 0.2F}) {
      found.assign(grid_.candidatesAtMost(reach_m), -1);
      const std::uint32_t count = grid_.candidatesWithin(place, reach_m, found.data());
      ASSERT_LE(count, found.size());
      found.resize(count);
      expectAllOf(within(place, reach_m), found, "candidatesWithin");
    }

    found.clear();
    const Float4 low{place.x - 0.012F, place.y - 0.012F, place.z - 0.012F, 0};
    const Float4 high{place.x + 0.012F, place.y + 0.012F, place.z + 0.012F, 0};
    grid_.forEachIn(grid_.blockOf(low, high), [&found](std::int32_t i) { found.push_back(i); });
    expectAllOf(within(place, 0.012), found, "forEachIn");
  }
}

TEST_P(RandomGrid, IsEmptyOnceAllHaveGone) {
  for (const bool one_by_one : {true, false}) {
    for (std::size_t i = 0; i < kParticles; ++i) {
      put(i);
    }
    if (one_by_one) {
      for (std::size_t i = 0; i < kParticles; ++i) {
        grid_.remove(static_cast<std::int32_t>(i), cell_[i]);
      }
    } else {
      grid_.clear();
    }
    std::vector<std::int32_t> found(grid_.candidatesAtMost());
    for (std::uint32_t cell = 0; cell < grid_.cells(); ++cell) {
      ASSERT_EQ(grid_.candidates(cell, found.data()), 0U);
    }
  }
}

TEST(CellGrid, FarFewerCandidatesThanParticles) {
  CellGrid grid(1000, kCell_m, {0.1, 0.1, 0.1, {}});
  for (int i = 0; i < 1000; ++i) {
    const auto at = [](int k) { return (static_cast<float>(k) + 0.5F) * 0.01F; };
    grid.insert(i, grid.cellOf({at(i % 10) - 0.05F, at(i / 10 % 10) - 0.05F, at(i / 100), 0}));
  }
  std::vector<std::int32_t> found(grid.candidatesAtMost());
  EXPECT_EQ(grid.candidates(grid.cellOf({0, 0, 0.05F, 0}), found.data()), 27U);
  EXPECT_EQ(grid.candidates(grid.cellOf({-0.05F, -0.05F, 0, 0}), found.data()), 8U) << "in a corner";
}

TEST(CellGrid, WhatIsNoNumberHasACell) {
  const CellGrid grid(10, kCell_m, {0.1, 0.1, 0.1, {}});
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr float kFar = std::numeric_limits<float>::infinity();
  for (const Float4& place : {Float4{kNaN, kNaN, kNaN, 0}, Float4{kFar, -kFar, kFar, 0}}) {
    EXPECT_LT(grid.cellOf(place), grid.cells());
  }
}

}  // namespace
}  // namespace haptolith
