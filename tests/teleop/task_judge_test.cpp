#include "haptolith/teleop/operator/task_judge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace haptolith {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTick_s = 1e-3;
const HeightGrid kGrid{-0.12, -0.14, 0.005, 48, 56};

/// A map with a pit from these cells on, with its length along x and width along y.
std::vector<double> pit(std::size_t column, std::size_t row, std::size_t columns, std::size_t rows, double depth_m) {
  std::vector<double> heights(kGrid.cells(), 0.002);
  for (std::size_t y = row; y < row + rows; ++y) {
    for (std::size_t x = column; x < column + columns; ++x) {
      heights[y * kGrid.columns + x] = -depth_m;
    }
  }
  return heights;
}

TEST(DeepestTrench, IsAsDeepAsItsMeanWhereverItLiesAndWhicheverWay) {
  EXPECT_NEAR(deepestTrench(kGrid, pit(3, 40, 14, 6, 0.05)), 0.05, 1e-12) << "60 by 24 mm are 12 by 5 cells";
  EXPECT_NEAR(deepestTrench(kGrid, pit(40, 1, 6, 14, 0.05)), 0.05, 1e-12);
  EXPECT_NEAR(deepestTrench(kGrid, pit(10, 10, 12, 5, 0.05)), 0.05, 1e-12);
  EXPECT_NEAR(deepestTrench(kGrid, pit(10, 10, 6, 5, 0.05)), (0.05 - 0.002) / 2, 1e-12) << "half of it is not dug";
  EXPECT_NEAR(deepestTrench(kGrid, std::vector<double>(kGrid.cells(), 0)), 0, 1e-12);
}

TEST(DeepestTrench, DoesNotLieWhereTheSoilIsNotKnown) {
  std::vector<double> heights = pit(10, 10, 12, 5, 0.05);
  heights[12 * kGrid.columns + 15] = kNan;
  const double with_hole_m = deepestTrench(kGrid, heights);
  EXPECT_GT(with_hole_m, 0);
  EXPECT_LT(with_hole_m, 0.03);
  EXPECT_TRUE(std::isnan(deepestTrench(kGrid, std::vector<double>(kGrid.cells(), kNan))));
  EXPECT_TRUE(std::isnan(deepestTrench({0, 0, 0.005, 8, 8}, std::vector<double>(64, -1)))) << "it is too small";
}

RobotReport report(double height_m, double force_n, std::uint32_t ticks = 20) {
  RobotReport report;
  report.ticks = ticks;
  report.pose.position_m.z() = height_m;
  report.met.force_n = {0, 0, force_n};
  return report;
}

/// Equal reports over a duration.
void tell(TaskJudge& judge, double duration_s, double height_m, double force_n) {
  for (int i = 0; i < static_cast<int>(std::lround(duration_s / (20 * kTick_s))); ++i) {
    judge.met(report(height_m, force_n), kTick_s);
  }
}

TEST(TaskJudge, APressIsDoneOnceItHasBeenHeld) {
  TaskJudge judge(SiteTask::kPress);
  EXPECT_TRUE(std::isnan(judge.reached()));
  tell(judge, 2, 0, 6);
  EXPECT_NEAR(judge.reached(), 6, 1e-9);
  tell(judge, 0.3, 0, 8);
  EXPECT_FALSE(judge.done()) << "it passes by";
  tell(judge, 1, 0, 10);
  EXPECT_FALSE(judge.done());
  tell(judge, 0.44, 0, 8.7);
  EXPECT_FALSE(judge.done()) << "not for half a second yet";
  tell(judge, 0.1, 0, 7.3);
  EXPECT_TRUE(judge.done());
  tell(judge, 2, 0, 0);
  EXPECT_TRUE(judge.done()) << "it has been done";
}

TEST(TaskJudge, ALoadIsWeighedInTheAir) {
  TaskJudge judge(SiteTask::kScoop);
  tell(judge, 2, 0.01, 5);
  EXPECT_FALSE(judge.done()) << "that is the soil's resistance";
  EXPECT_TRUE(std::isnan(judge.reached()));
  tell(judge, 2, 0.05, 0.06);
  EXPECT_FALSE(judge.done());
  EXPECT_NEAR(judge.reached(), 0.06, 1e-9);
  tell(judge, 0.3, 0.05, 0.12);
  EXPECT_FALSE(judge.done());
  tell(judge, 0.02, 0.02, 0.12);
  tell(judge, 0.3, 0.05, 0.12);
  EXPECT_FALSE(judge.done()) << "it was down in between";
  tell(judge, 0.3, 0.05, 0.12);
  EXPECT_TRUE(judge.done());
}

TEST(TaskJudge, WhatARobotTellsThatFollowsNobodyDoesNotCount) {
  TaskJudge judge(SiteTask::kPress);
  for (int i = 0; i < 100; ++i) {
    judge.met(report(0, 8, 0), kTick_s);
  }
  EXPECT_FALSE(judge.done());
}

TEST(TaskJudge, ATrenchIsDoneOnceTheMapShowsIt) {
  TaskJudge judge(SiteTask::kTrench);
  SiteMap site;
  judge.look(site);
  EXPECT_TRUE(std::isnan(judge.reached()));
  constexpr HeightGrid kSmall{-0.08, -0.04, 0.01, 16, 8};
  SitePacket packet{.robot_connection = 1, .grid = kSmall, .columns = 16, .rows = 8, .number = 1};
  packet.steps.assign(kSmall.cells(), static_cast<std::int16_t>(-0.03 / SitePacket::kStep_m));
  ASSERT_TRUE(site.take(packet));
  judge.look(site);
  EXPECT_FALSE(judge.done());
  EXPECT_NEAR(judge.reached(), 0.03, 1e-9);
  packet.number = 2;
  packet.steps.assign(kSmall.cells(), static_cast<std::int16_t>(-0.041 / SitePacket::kStep_m));
  ASSERT_TRUE(site.take(packet));
  judge.look(site);
  EXPECT_TRUE(judge.done());
}

}  // namespace
}  // namespace haptolith
