#include "haptolith/teleop/operator/task_operator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>

#include "haptolith/teleop/link/site_packet.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;
const Pose kHome{{0, 0, 0.08}, Quat::Identity()};
const HeightGrid kGrid{-0.08, -0.08, 0.01, 16, 16};

/// Heights of a site with a hole of this depth at the centre.
std::vector<double> dug(double depth_m) {
  std::vector<double> heights(kGrid.cells(), 0);
  for (std::size_t cell = 0; cell < heights.size(); ++cell) {
    const double y_m = kGrid.y_m + (static_cast<double>(cell / kGrid.columns) + 0.5) * kGrid.cell_m;
    heights[cell] = std::abs(y_m) < 0.02 ? -depth_m : 0;
  }
  return heights;
}

SitePacket seen(double depth_m, std::uint64_t number) {
  SitePacket packet{.robot_connection = 1, .grid = kGrid, .columns = 16, .rows = 16, .number = number};
  for (const double height_m : dug(depth_m)) {
    packet.steps.push_back(static_cast<std::int16_t>(std::lround(height_m / SitePacket::kStep_m)));
  }
  return packet;
}

/// A hand that is wherever it is wanted, and a site that is as deep as the blade's edge went less 2 mm, seen late.
struct World {
  double late_s;
  bool has_model;
  double model_deeper_m = 0;  ///< than the site

  double depth_m = 0;
  std::deque<double> on_the_way = {};
  SiteMap site = {};
  Pose tool = kHome;
  double now_s = 0;

  void dig(TaskOperator& hand, double duration_s) {
    for (std::uint64_t tick = 0; !hand.done() && now_s < duration_s; ++tick, now_s += kTick_s) {
      TaskSight sight{now_s, tick, tool, 0, 0, 0, &site};
      if (has_model) {
        sight.own = [&](const HeightGrid& grid) {
          EXPECT_EQ(grid, site.grid());
          return dug(depth_m + (depth_m > 0 ? model_deeper_m : 0));
        };
      }
      tool = hand.wanted(sight);
      const bool upright = (tool.orientation * Vec3::UnitX()).z() < -0.9;
      const double edge_m = -(tool.position_m.z() - 0.025 * std::sin(1.2217));
      if (upright && std::abs(tool.position_m.x()) < 0.01) {
        depth_m = std::max(depth_m, edge_m - 0.002);
      }
      on_the_way.push_back(depth_m);
      if (static_cast<double>(on_the_way.size()) * kTick_s > late_s) {
        if (tick % 50 == 0) {
          site.take(seen(on_the_way.front(), tick + 1));
        }
        on_the_way.pop_front();
      }
    }
  }
};

TEST(TaskOperator, DigsDeeperStrokeByStrokeUntilTheSiteIsSeenToBeDeepEnough) {
  World at_once{.late_s = 0.01, .has_model = true};
  TaskOperator hand(SiteTask::kTrench, 0, kHome);
  at_once.dig(hand, 100);
  EXPECT_TRUE(hand.done());
  EXPECT_EQ(hand.strokes(), 3) << "15, 30, 43 mm";
  EXPECT_NEAR(hand.reached(), 0.041, 2e-4);
  EXPECT_LT(at_once.now_s, 30);

  World late{.late_s = 2.6, .has_model = true};
  TaskOperator with_model(SiteTask::kTrench, 2.6, kHome);
  late.dig(with_model, 100);
  EXPECT_TRUE(with_model.done());
  EXPECT_GT(late.now_s, at_once.now_s + 0.5) << "one look in the end";
  EXPECT_LT(late.now_s, at_once.now_s + 2.7) << "while the stroke goes on";

  World blind{.late_s = 2.6, .has_model = false};
  TaskOperator without(SiteTask::kTrench, 2.6, kHome);
  blind.dig(without, 100);
  EXPECT_TRUE(without.done());
  EXPECT_EQ(without.strokes(), 3);
  EXPECT_NEAR(blind.now_s, late.now_s + 2 * 3.2, 0.3) << "a look after each stroke";
}

TEST(TaskOperator, AModelThatPromisesTooMuchCostsAnotherStroke) {
  World world{.late_s = 1, .has_model = true, .model_deeper_m = 0.012};
  TaskOperator hand(SiteTask::kTrench, 1, kHome);
  world.dig(hand, 100);
  EXPECT_TRUE(hand.done());
  EXPECT_GE(world.depth_m, 0.04) << "it goes by the site, not by its model";
  EXPECT_EQ(hand.strokes(), 3);
}

TEST(TaskOperator, DoesNotSayThatItIsDoneWhereNothingIsSeen) {
  World world{.late_s = 1e9, .has_model = false};
  TaskOperator hand(SiteTask::kTrench, 0, kHome);
  world.dig(hand, 60);
  EXPECT_FALSE(hand.done());
}

TEST(TaskOperator, PressesUntilTheRobotHasMetWhatItIsToMeet) {
  for (const bool has_model : {true, false}) {
    // A spring here, one that is 1.5 times as stiff at the site, seen a second later.
    constexpr double kStiffness_n_m = 1000, kRatio = 1.5;
    TaskOperator hand(SiteTask::kPress, 1, kHome);
    std::deque<double> met;
    Pose tool = kHome;
    SiteMap site;
    double now_s = 0;
    for (std::uint64_t tick = 0; !hand.done() && now_s < 100; ++tick, now_s += kTick_s) {
      const double displayed_n = std::max(0.0, -kStiffness_n_m * tool.position_m.z());
      met.push_back(kRatio * displayed_n);
      const bool heard = met.size() > 1000;
      TaskSight sight{now_s,
                      tick,
                      tool,
                      has_model ? displayed_n : heard ? met.front() : 0,
                      heard ? met.front() : 0,
                      heard ? tick - 1000 : 0,
                      &site};
      if (has_model) {
        sight.own = [](const HeightGrid&) { return std::vector<double>(); };
      }
      if (heard) {
        met.pop_front();
      }
      tool = hand.wanted(sight);
    }
    EXPECT_TRUE(hand.done());
    EXPECT_NEAR(hand.reached(), 8, 0.8);
    EXPECT_NEAR(-kRatio * kStiffness_n_m * tool.position_m.z(), 8, 0.8);
    if (has_model) {
      EXPECT_EQ(hand.strokes(), 2) << "with the model's force, and put right";
    } else {
      EXPECT_GT(now_s, 3 * 1.6) << "2 mm at a time, and a look after each";
    }
  }
}

TEST(TaskOperator, ScoopsDeeperUntilTheRobotHasLiftedEnough) {
  TaskOperator hand(SiteTask::kScoop, 1, kHome);
  std::deque<double> met;
  Pose tool = kHome;
  SiteMap site;
  double deepest_m = 0, now_s = 0, load_n = 0;
  for (std::uint64_t tick = 0; !hand.done() && now_s < 100; ++tick, now_s += kTick_s) {
    deepest_m = std::max(deepest_m, -tool.position_m.z());
    if (tool.position_m.z() > 0.049) {
      const bool tipped = (tool.orientation * Vec3::UnitX()).z() < -0.8;
      load_n = tipped ? 0 : deepest_m > 0 ? 5 * deepest_m : 0;  // 0.042 N at first, 0.084, 0.126
      deepest_m = tipped ? 0 : deepest_m;
    }
    met.push_back(load_n);
    const bool heard = met.size() > 1000;
    tool = hand.wanted({now_s, tick, tool, load_n, heard ? met.front() : 0, heard ? tick - 1000 : 0, &site});
    if (heard) {
      met.pop_front();
    }
  }
  EXPECT_TRUE(hand.done());
  EXPECT_EQ(hand.strokes(), 3);
  EXPECT_NEAR(hand.reached(), 0.126, 0.01) << "not what was heard of the scoop before";
}

TEST(TrenchDepth, IsTheMeanOfCellsAlongItsMiddleAndKnownOnlyWhereAllAre) {
  EXPECT_NEAR(trenchDepth(kGrid, dug(0.03)), 0.03, 1e-12);
  std::vector<double> heights = dug(0.03);
  heights[8 * 16 + 8] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(trenchDepth(kGrid, heights)));
  EXPECT_TRUE(std::isnan(trenchDepth({}, {})));
}

}  // namespace
}  // namespace haptolith
