#include "haptolith/haptics/wrench_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;

TEST(WrenchFilter, AnswersAStepAtEveryTickAsTheAnalogueFilterWould) {
  WrenchFilter filter(30, kTick_s);
  const Wrench step{Vec3(2, -3, 4), Vec3(0.1, 0.2, -0.3)};
  for (int tick = 1; tick <= 200; ++tick) {
    const Wrench& out = filter.step(step);
    const double share = 1 - std::exp(-2 * std::numbers::pi * 30 * tick * kTick_s);
    // Two hundred roundings of 1e-16.
    ASSERT_LT((out.force_n - share * step.force_n).norm(), 1e-13) << tick;
    ASSERT_LT((out.torque_nm - share * step.torque_nm).norm(), 1e-13) << tick;
  }
}

TEST(WrenchFilter, IsThreeDecibelsDownAtItsCutoff) {
  WrenchFilter filter(30, kTick_s);
  double largest = 0;
  for (int tick = 0; tick < 2000; ++tick) {
    const double in = std::sin(2 * std::numbers::pi * 30 * tick * kTick_s);
    const double out = filter.step({Vec3(in, 0, 0), Vec3::Zero()}).force_n.x();
    largest = tick > 1000 ? std::max(largest, std::abs(out)) : 0;
  }
  // |H| = s / |e^iw - (1 - s)|, s = 1 - exp(-w), w = 2 pi 0.03: 0.7105; sampling may miss the peak by 0.5 %.
  EXPECT_NEAR(largest, 0.7105, 0.005);
}

TEST(WrenchFilter, IsExactlyZeroSoonAfterTheInputHasEnded) {
  WrenchFilter filter(30, kTick_s);
  for (int tick = 0; tick < 1000; ++tick) {
    filter.step({Vec3(10, 10, 10), Vec3(1, 1, 1)});
  }
  // 17 N fall to 1e-6 N within ln(1.7e7) / (2 pi 30) = 88 ms.
  int ticks = 0;
  while (filter.step(Wrench{}).force_n != Vec3::Zero() && ticks < 1000) {
    ++ticks;
  }
  EXPECT_LE(ticks, 89);
  EXPECT_GE(ticks, 80);
  EXPECT_EQ(filter.step(Wrench{}).torque_nm, Vec3::Zero());
}

TEST(WrenchFilter, ASmallForceThatLastsIsNotCut) {
  WrenchFilter filter(30, kTick_s);
  Wrench out;
  for (int tick = 0; tick < 500; ++tick) {
    out = filter.step({Vec3(1e-8, 0, 0), Vec3::Zero()});
  }
  EXPECT_NEAR(out.force_n.x(), 1e-8, 1e-14);
}

TEST(WrenchFilter, RefusesCutoffsThatTheTickCannotShow) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (const double cutoff : {0.0, -1.0, 501.0, kNaN, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW((WrenchFilter{cutoff, kTick_s}), InvalidParameter) << cutoff;
  }
  EXPECT_NO_THROW((WrenchFilter{500, kTick_s}));
}

TEST(Limited, ShortensAndKeepsTheDirection) {
  const Wrench wrench{Vec3(30, -40, 0), Vec3(0, 0.3, 0.4)};
  const Wrench felt = limited(wrench, {.max_force_n = 12, .max_torque_nm = 0.2});
  EXPECT_LT((felt.force_n - Vec3(7.2, -9.6, 0)).norm(), 1e-12);
  EXPECT_LT((felt.torque_nm - Vec3(0, 0.12, 0.16)).norm(), 1e-12);
}

TEST(Limited, LeavesAloneWhatTheDeviceCanShow) {
  const Wrench wrench{Vec3(3, 4, 0), Vec3(0, 0.03, 0.04)};
  const Wrench felt = limited(wrench, {.max_force_n = 5, .max_torque_nm = 0.05});
  EXPECT_EQ(felt.force_n, wrench.force_n);
  EXPECT_EQ(felt.torque_nm, wrench.torque_nm);
  EXPECT_EQ(limited(wrench, DeviceLimits{}).force_n, wrench.force_n);
  EXPECT_EQ(limited({}, {.max_force_n = 0, .max_torque_nm = 0}).force_n, Vec3::Zero());
}

TEST(WrenchFilter, AForceThatTheHandsOwnMovementExplainsIsNotDelayed) {
  WrenchFilter filter(30, kTick_s);
  Vec3 force = Vec3::Zero();
  for (int tick = 0; tick < 100; ++tick) {
    const Vec3 change(0.01 * std::sin(0.3 * tick), 0.02, 0);
    force += change;
    ASSERT_LT((filter.step({force, Vec3::Zero()}, change).force_n - force).norm(), 1e-13) << tick;
  }
}

/// Largest answer to a swing of amplitude 1 m/s around a steady 0.1 m/s.
double quickShareOf(double frequency_hz) {
  QuickMovement quick(kTick_s);
  double largest = 0;
  for (int tick = 0; tick < 4000; ++tick) {
    const Vec3 out = quick.step(Vec3(0.1 + std::sin(2 * std::numbers::pi * frequency_hz * tick * kTick_s), 0, 0));
    largest = tick > 2000 ? std::max(largest, out.x()) : 0;
  }
  return largest;
}

TEST(QuickMovement, IsNothingOfASteadyMovementLittleOfStirringAndMostOfShaking) {
  // |H| with H = (1 - s) (1 - e^-iw) / (1 - (1 - s) e^-iw), s = 1 - exp(-2 pi 0.006): 0.161 and 0.940. The largest
  // sample misses a peak at 20 Hz, 50 samples a turn, by at most 0.2 %.
  EXPECT_NEAR(quickShareOf(1), 0.161, 1e-3);
  EXPECT_NEAR(quickShareOf(20), 0.940, 3e-3);
  QuickMovement quick(kTick_s);
  Vec3 out;
  for (int tick = 0; tick < 1000; ++tick) {
    out = quick.step(Vec3(0.1, 0, 0));
  }
  EXPECT_LT(out.norm(), 1e-12);
}

}  // namespace
}  // namespace haptolith
