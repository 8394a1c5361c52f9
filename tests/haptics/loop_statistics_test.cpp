#include "haptolith/haptics/loop/loop_statistics.h"

#include <gtest/gtest.h>

namespace haptolith {
namespace {

TEST(LoopStatistics, BeforeTheFirstTickAllIsWell) {
  const LoopStatistics statistics;
  EXPECT_EQ(statistics.ticks(), 0U);
  EXPECT_EQ(statistics.successRate(), 1);
  EXPECT_EQ(statistics.deadlineMisses(), 0U);
}

TEST(LoopStatistics, SuccessRateIsThatOfTheLastHundredTicks) {
  LoopStatistics statistics;
  for (int i = 0; i < 10; ++i) {
    statistics.add(100, i % 2 == 0 ? Miss::kNone : Miss::kWokenLate, {});
  }
  EXPECT_DOUBLE_EQ(statistics.successRate(), 0.5);  // over the existing ones while there are fewer than ten
  for (int i = 0; i < 95; ++i) {
    statistics.add(100, Miss::kNone, {});
  }
  // 105 ticks: of the last hundred, ticks 5 to 9 hold the misses 5, 7 and 9.
  EXPECT_DOUBLE_EQ(statistics.successRate(), 0.97);
  for (int i = 0; i < 5; ++i) {
    statistics.add(100, Miss::kNone, {});
  }
  EXPECT_EQ(statistics.successRate(), 1);
  EXPECT_EQ(statistics.deadlineMisses(), 5U);  // all of them, for ever
  EXPECT_EQ(statistics.ticks(), 110U);
}

TEST(LoopStatistics, CountsMissesByTheirCause) {
  LoopStatistics statistics;
  for (const Miss miss : {Miss::kTooLong, Miss::kNone, Miss::kWokenLate, Miss::kTooLong, Miss::kPreempted}) {
    statistics.add(100, miss, {});
  }
  EXPECT_EQ(statistics.misses(Miss::kTooLong), 2U);
  EXPECT_EQ(statistics.misses(Miss::kWokenLate), 1U);
  EXPECT_EQ(statistics.misses(Miss::kPreempted), 1U);
  EXPECT_EQ(statistics.deadlineMisses(), 4U);
}

TEST(LoopStatistics, CollectsTimesForcesAndTorques) {
  LoopStatistics statistics;
  statistics.add(10, Miss::kNone, {Vec3(3, 4, 0), Vec3(0, 0, 0.1)});
  statistics.add(30, Miss::kNone, {Vec3(0, 0, -1), Vec3(0, 0, 0)});
  EXPECT_DOUBLE_EQ(statistics.tickUs().mean(), 20);
  EXPECT_DOUBLE_EQ(statistics.tickUs().max(), 30);
  EXPECT_DOUBLE_EQ(statistics.forceN().mean(), 3);
  EXPECT_DOUBLE_EQ(statistics.forceN().max(), 5);
  EXPECT_DOUBLE_EQ(statistics.torqueNm().max(), 0.1);
  EXPECT_EQ(statistics.lateUs().count(), 0U);
  statistics.addLateness(7);
  statistics.addLateness(9);
  EXPECT_EQ(statistics.lateUs().count(), 2U);
  EXPECT_DOUBLE_EQ(statistics.lateUs().mean(), 8);
  EXPECT_EQ(statistics.ticks(), 2U) << "lateness is no tick";
}

}  // namespace
}  // namespace haptolith
