#include "haptolith/machine/deadline_report.h"

#include <gtest/gtest.h>

namespace haptolith {
namespace {

LoopStatistics run(int too_long, int woken_late, int preempted, int ticks = 10'000) {
  LoopStatistics statistics;
  const auto add = [&](int count, Miss miss) {
    for (int i = 0; i < count; ++i) {
      statistics.add(100, miss, {});
    }
  };
  add(too_long, Miss::kTooLong);
  add(woken_late, Miss::kWokenLate);
  add(preempted, Miss::kPreempted);
  add(ticks - too_long - woken_late - preempted, Miss::kNone);
  return statistics;
}

TEST(DeadlineReport, SaysHowManyForWhichCause) {
  EXPECT_EQ(deadlinesText(run(1, 2, 0)),
            "3 missed: 1 tick too long, 2 woken late, 0 processor taken away; 100 % of the last 100 in time");
  EXPECT_EQ(deadlinesText(run(40, 0, 10, 50)),
            "50 missed: 40 ticks too long, 0 woken late, 10 processor taken away; 0 % of the last 100 in time");
  EXPECT_EQ(deadlinesText(run(0, 0, 0)), "0 missed; 100 % of the last 100 in time");
}

TEST(DeadlineReport, AdvisesCoarserSoilWhereTicksTakeTooLong) {
  EXPECT_EQ(deadlineAdvice(run(2500, 10, 10), "haptolith run --coarser"),
            "the particles are too small for this machine: 25 % of ticks took too long; try: haptolith run --coarser");
  EXPECT_EQ(deadlineAdvice(run(11, 0, 0), "X"),
            "the particles are too small for this machine: 0.11 % of ticks took too long; try: X");
  EXPECT_EQ(deadlineAdvice(run(200, 0, 0, 200), "X"),
            "the particles are too small for this machine: 100 % of ticks took too long; try: X");
}

TEST(DeadlineReport, PointsToTheDoctorWhereTheMachineIsTheCause) {
  EXPECT_EQ(deadlineAdvice(run(30, 60, 40), "X"),
            "other programs or the host of a virtual machine use the CPU: 1 % of ticks were woken late or "
            "interrupted; see: haptolith doctor");
}

TEST(DeadlineReport, HasNoAdviceForAFewMisses) {
  EXPECT_EQ(deadlineAdvice(run(10, 0, 0), "X"), "");
  EXPECT_EQ(deadlineAdvice(run(0, 5, 5), "X"), "");
  EXPECT_EQ(deadlineAdvice(LoopStatistics{}, "X"), "");
}

}  // namespace
}  // namespace haptolith
