#include "haptolith/study/results/felt_summary.h"

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

TEST(FeltSummary, KnowsNothingBeforeTheFirstTick) {
  const TrialSummary felt = FeltSummary().summary();
  EXPECT_TRUE(std::isnan(felt.duration_s));
  EXPECT_TRUE(std::isnan(felt.mean_force_n));
  EXPECT_EQ(felt.deadline_misses, 0);
}

TEST(FeltSummary, AddsUpAMovementAgainstAConstantForce) {
  FeltSummary summary;
  for (int i = 0; i <= 1000; ++i) {
    summary.add(tick(5 + 1e-3 * i, {1e-4 * i, 0, 0}, {-2, 0, 0}));
  }
  const TrialSummary felt = summary.summary();
  EXPECT_NEAR(felt.duration_s, 1, 1e-9);
  EXPECT_NEAR(felt.path_m, 0.1, 1e-9);
  EXPECT_NEAR(felt.mean_speed_m_s, 0.1, 1e-9);
  EXPECT_NEAR(felt.peak_speed_m_s, 0.1, 1e-6);
  EXPECT_NEAR(felt.mean_force_n, 2, 1e-9);
  EXPECT_NEAR(felt.peak_force_n, 2, 1e-9);
  EXPECT_NEAR(felt.force_sd_n, 0, 1e-6);
  EXPECT_NEAR(felt.peak_torque_nm, 0.6, 1e-9);
  EXPECT_NEAR(felt.work_j, 0.2, 1e-9) << "the hand does work on soil that resists";
}

TEST(FeltSummary, ASpringGivesItsEnergyBack) {
  FeltSummary summary;
  for (int i = 0; i <= 2000; ++i) {
    const double x_m = 0.01 * std::sin(3.14159265358979 * i / 2000);
    summary.add(tick(1e-3 * i, {x_m, 0, 0}, {-500 * x_m, 0, 0}));
  }
  EXPECT_NEAR(summary.summary().work_j, 0, 1e-9);
  EXPECT_NEAR(summary.summary().path_m, 0.02, 1e-6);
  EXPECT_NEAR(summary.summary().force_sd_n, 5 * std::sqrt(0.5 - 4 / (3.14159265 * 3.14159265)), 0.01);
}

TEST(FeltSummary, CountsLateTicksAndForgivesAPause) {
  FeltSummary summary;
  TickRecord late = tick(0, Vec3::Zero(), Vec3::Zero());
  late.flags = kTickLate;
  summary.add(late);
  summary.add(tick(0, Vec3(1, 0, 0), Vec3::Zero()));  // no time has passed: no speed
  EXPECT_EQ(summary.summary().deadline_misses, 1);
  EXPECT_TRUE(std::isnan(summary.summary().peak_speed_m_s));
}

}  // namespace
}  // namespace haptolith
