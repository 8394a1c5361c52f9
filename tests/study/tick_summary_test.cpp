#include "haptolith/study/results/tick_summary.h"

#include <gtest/gtest.h>

#include <cmath>

namespace haptolith {
namespace {

/// A tick at this time, the tool here, the soil pushing it with this force, which is felt as it is.
TickRecord tick(double time_s, const Vec3& position_m, const Vec3& force_n) {
  TickRecord record;
  record.time_s = time_s;
  record.scene_T_tool.position_m = position_m;
  record.soil.force_n = force_n;
  record.sent.wrench.force_n = force_n;
  record.sent.wrench.torque_nm = {0, 0.1 * time_s, 0};
  return record;
}

TEST(TickSummary, KnowsNothingBeforeTheFirstTick) {
  const TrialSummary summary = TickSummary().summary();
  EXPECT_TRUE(std::isnan(summary.duration_s));
  EXPECT_TRUE(std::isnan(summary.mean_force_n));
  EXPECT_EQ(summary.deadline_misses, 0);
}

TEST(TickSummary, AddsUpAMovementAgainstAConstantForce) {
  TickSummary ticks;
  for (int i = 0; i <= 1000; ++i) {
    ticks.add(tick(5 + 1e-3 * i, {1e-4 * i, 0, 0}, {-2, 0, 0}));
  }
  const TrialSummary summary = ticks.summary();
  EXPECT_NEAR(summary.duration_s, 1, 1e-9);
  EXPECT_NEAR(summary.path_m, 0.1, 1e-9);
  EXPECT_NEAR(summary.mean_speed_m_s, 0.1, 1e-9);
  EXPECT_NEAR(summary.peak_speed_m_s, 0.1, 1e-6);
  EXPECT_NEAR(summary.mean_force_n, 2, 1e-9);
  EXPECT_NEAR(summary.peak_force_n, 2, 1e-9);
  EXPECT_NEAR(summary.force_sd_n, 0, 1e-6);
  EXPECT_NEAR(summary.peak_torque_nm, 0.6, 1e-9);
  EXPECT_NEAR(summary.work_j, 0.2, 1e-9) << "the hand does work on soil that resists";
}

TEST(TickSummary, ASpringGivesItsEnergyBack) {
  TickSummary ticks;
  for (int i = 0; i <= 2000; ++i) {
    const double x_m = 0.01 * std::sin(3.14159265358979 * i / 2000);
    ticks.add(tick(1e-3 * i, {x_m, 0, 0}, {-500 * x_m, 0, 0}));
  }
  EXPECT_NEAR(ticks.summary().work_j, 0, 1e-9);
  EXPECT_NEAR(ticks.summary().path_m, 0.02, 1e-6);
  EXPECT_NEAR(ticks.summary().force_sd_n, 5 * std::sqrt(0.5 - 4 / (3.14159265 * 3.14159265)), 0.01);
}

TEST(TickSummary, CountsLateTicksAndForgivesAPause) {
  TickSummary ticks;
  TickRecord late = tick(0, Vec3::Zero(), Vec3::Zero());
  late.flags = kTickLate;
  ticks.add(late);
  ticks.add(tick(0, Vec3(1, 0, 0), Vec3::Zero()));  // no time has passed: no speed
  EXPECT_EQ(ticks.summary().deadline_misses, 1);
  EXPECT_TRUE(std::isnan(ticks.summary().peak_speed_m_s));
}

}  // namespace
}  // namespace haptolith
