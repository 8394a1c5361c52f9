#include "haptolith/haptics/safety/safety_layer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <set>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/core/math/random.h"
#include "haptolith/haptics/tick_record.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;
constexpr double kStorage_n_m = 500;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Something like a small device of the market.
DeviceLimits small() {
  DeviceLimits limits;
  limits.max_force_n = 3.3;
  limits.max_torque_nm = 0.2;
  limits.max_gripper_force_n = 2;
  limits.max_force_rate_n_s = 500;
  limits.max_torque_rate_nm_s = 20;
  limits.max_gripper_rate_n_s = 100;
  limits.workspace_radius_m = 0.2;
  return limits;
}

DeviceOutput force(double z_n) {
  return {{Vec3(0, 0, z_n), Vec3::Zero()}};
}

bool isNothing(const DeviceOutput& output) {
  return output.wrench.force_n == Vec3::Zero() && output.wrench.torque_nm == Vec3::Zero() &&
         output.gripper_force_n == 0;
}

SafetyLayer forPerson(const SafetyParameters& parameters = {}, const DeviceLimits& limits = small()) {
  return {parameters, limits, false, kStorage_n_m, kTick_s};
}

SafetyLayer forSimulation(const SafetyParameters& parameters = {}, const DeviceLimits& limits = small()) {
  return {parameters, limits, true, kStorage_n_m, kTick_s};
}

/// Runs a number of ticks with a hand at rest; returns the last output.
DeviceOutput after(SafetyLayer& safety, int ticks, const DeviceOutput& rendered, const DeviceInput& input = {}) {
  DeviceOutput felt;
  for (int tick = 0; tick < ticks; ++tick) {
    safety.check(input, {});
    felt = safety.step(rendered);
  }
  return felt;
}

TEST(SafetyLayer, LeavesAloneWhatIsSafeBitForBit) {
  SafetyLayer safety = forSimulation();
  std::mt19937_64 random(3);
  DeviceOutput rendered;
  for (int tick = 0; tick < 1000; ++tick) {
    safety.check({}, {});
    const Vec3 step_n(uniformSigned(random), uniformSigned(random), uniformSigned(random));
    rendered.wrench.force_n = 0.9 * rendered.wrench.force_n + 0.1 * step_n;
    rendered.wrench.torque_nm = 0.9 * rendered.wrench.torque_nm + 0.004 * step_n;
    rendered.gripper_force_n = 0.9 * rendered.gripper_force_n + 0.02 * step_n.x();
    const DeviceOutput felt = safety.step(rendered);
    ASSERT_EQ(felt.wrench.force_n, rendered.wrench.force_n);
    ASSERT_EQ(felt.wrench.torque_nm, rendered.wrench.torque_nm);
    ASSERT_EQ(felt.gripper_force_n, rendered.gripper_force_n);
    ASSERT_EQ(safety.flags(), 0U);
  }
}

TEST(SafetyLayer, WhateverHappensForcesStayWithinTheLimitsAndJumpToNothingOnly) {
  for (const bool simulated : {true, false}) {
    SafetyParameters parameters;
    parameters.soft_start_s = 0.05;
    parameters.recovery_s = 0.02;
    SafetyLayer safety(parameters, small(), simulated, kStorage_n_m, kTick_s);
    std::mt19937_64 random(5);
    const auto any = [&random] { return Vec3(uniformSigned(random), uniformSigned(random), uniformSigned(random)); };
    DeviceOutput last;
    DeviceInput input;
    int zeroed = 0, shown = 0;
    for (int tick = 0; tick < 50'000; ++tick) {
      DeviceInput told = input;
      input.pose.position_m = 0.9 * input.pose.position_m + 4e-3 * any();  // up to 9 m/s
      const double dice = uniformSigned(random);
      told.state = dice > 0.998 ? DeviceState::kStale : dice < -0.998 ? DeviceState::kLost : DeviceState::kLive;
      if (std::abs(dice) < 5e-4) {
        told.twist.linear_m_s.x() = kNaN;
      }
      safety.check(told, {std::abs(dice) > 0.9, std::abs(dice - 0.5) < 2e-4});
      DeviceOutput rendered{{30 * any(), 1 * any()}, 5 * uniformSigned(random)};
      if (std::abs(dice + 0.5) < 2e-4) {
        rendered.wrench.force_n.y() = kNaN;
      }
      const DeviceOutput felt = safety.step(rendered);
      ASSERT_LE(felt.wrench.force_n.norm(), 3.3 * (1 + 1e-12));
      ASSERT_LE(felt.wrench.torque_nm.norm(), 0.2 * (1 + 1e-12));
      ASSERT_LE(std::abs(felt.gripper_force_n), 2);
      if (safety.trip() != SafetyTrip::kNone) {
        ASSERT_TRUE(isNothing(felt));
        ASSERT_NE(safety.flags() & kTickForceZeroed, 0U);
        ++zeroed;
      } else {
        ASSERT_LE((felt.wrench.force_n - last.wrench.force_n).norm(), 0.5 * (1 + 1e-12));
        ASSERT_LE((felt.wrench.torque_nm - last.wrench.torque_nm).norm(), 0.02 * (1 + 1e-12));
        ASSERT_LE(std::abs(felt.gripper_force_n - last.gripper_force_n), 0.1 * (1 + 1e-12));
        shown += isNothing(felt) ? 0 : 1;
      }
      last = felt;
    }
    EXPECT_GT(zeroed, 1000);
    EXPECT_GT(shown, 1000);
  }
}

TEST(SafetyLayer, ShortensButDoesNotTurn) {
  SafetyLayer safety = forSimulation();
  const Vec3 direction = Vec3(1, -2, 3).normalized();
  const DeviceOutput felt = after(safety, 100, {{10 * direction, -direction}, 5});
  EXPECT_LT((felt.wrench.force_n - 3.3 * direction).norm(), 1e-12);
  EXPECT_LT((felt.wrench.torque_nm + 0.2 * direction).norm(), 1e-12);
  EXPECT_EQ(felt.gripper_force_n, 2);
  EXPECT_EQ(safety.flags(), kTickForceSaturated);
}

TEST(SafetyLayer, OnesOwnLimitCountsWhereItIsBelowTheDevices) {
  SafetyParameters parameters;
  parameters.max_force_n = 1.5;
  parameters.max_torque_nm = 7;
  SafetyLayer safety = forSimulation(parameters);
  const DeviceOutput felt = after(safety, 100, {{Vec3(10, 0, 0), Vec3(0, 9, 0)}});
  EXPECT_NEAR(felt.wrench.force_n.x(), 1.5, 1e-12);
  EXPECT_NEAR(felt.wrench.torque_nm.y(), 0.2, 1e-12);
}

TEST(SafetyLayer, AStepIsReachedAtTheDevicesRate) {
  SafetyLayer safety = forSimulation();
  for (int tick = 1; tick <= 6; ++tick) {
    EXPECT_NEAR(after(safety, 1, force(3)).wrench.force_n.z(), std::min(3.0, 0.5 * tick), 1e-12);
    EXPECT_EQ(safety.flags(), tick < 6 ? kTickForceRateLimited : 0U);
  }
}

TEST(SafetyLayer, APersonsDeviceStartsSoftlyOverTwoSecondsASimulatedOneAtOnce) {
  SafetyLayer person = forPerson();
  double last_n = 0;
  for (int tick = 1; tick < 2000; ++tick) {
    const double now_n = after(person, 1, force(3)).wrench.force_n.z();
    const double share = tick / 2000.0;
    ASSERT_NEAR(now_n, 3 * share * share * (3 - 2 * share), 1e-9) << tick;
    ASSERT_GE(now_n, last_n);
    ASSERT_EQ(person.flags(), kTickSoftStart);
    last_n = now_n;
  }
  EXPECT_NEAR(after(person, 2, force(3)).wrench.force_n.z(), 3, 1e-12);
  EXPECT_EQ(person.flags(), 0U);
  SafetyLayer simulated = forSimulation();
  EXPECT_NEAR(after(simulated, 10, force(3)).wrench.force_n.z(), 3, 1e-12);
}

TEST(SafetyLayer, ASoftStartIsAsSlowForAForceThatTheDeviceCannotShow) {
  SafetyLayer safety = forPerson();
  EXPECT_NEAR(after(safety, 1000, force(100)).wrench.force_n.z(), 3.3 / 2, 1e-9);
}

TEST(SafetyLayer, StopsSoftly) {
  SafetyLayer safety = forPerson();
  (void)after(safety, 2100, force(3));
  EXPECT_FALSE(safety.stopped());
  safety.stop();
  double last_n = 3;
  int ticks = 0;
  for (; !safety.stopped() && ticks < 1000; ++ticks) {
    const double now_n = after(safety, 1, force(3)).wrench.force_n.z();
    ASSERT_LE(now_n, last_n);
    ASSERT_LT(last_n - now_n, 0.03) << "200 ms for 3 N";
    last_n = now_n;
  }
  EXPECT_NEAR(ticks, 200, 1);
  EXPECT_EQ(last_n, 0);
}

TEST(SafetyLayer, AHandThatHasBeenLetGoNeedsNoSoftStop) {
  SafetyLayer safety = forPerson();
  (void)after(safety, 2100, force(3));
  DeviceInput stale;
  stale.state = DeviceState::kStale;
  (void)after(safety, 1, force(3), stale);
  safety.stop();
  EXPECT_TRUE(safety.stopped()) << "else a run with a device that has gone silent would never end";
}

TEST(SafetyLayer, NobodyWaitsForTheSoftStopOfASimulatedHand) {
  SafetyLayer safety = forSimulation();
  (void)after(safety, 10, force(3));
  safety.stop();
  EXPECT_TRUE(safety.stopped());
  EXPECT_EQ(after(safety, 1, force(3)).wrench.force_n.z(), 3);
}

struct Trip {
  const char* name;
  SafetyTrip trip;
  std::function<void(DeviceInput&)> spoil;
  int comes_back_after = 0;  ///< ticks: 1 when the way back is a movement that no hand makes
};

class Trips : public testing::TestWithParam<Trip> {};

TEST_P(Trips, EndInNothingAtOnceAndForceComesBackSoftlyOnceAllHasBeenWellForAWhile) {
  SafetyLayer safety = forPerson();
  ASSERT_GT(after(safety, 2100, force(3)).wrench.force_n.z(), 2.9);
  DeviceInput bad;
  GetParam().spoil(bad);
  safety.check(bad, {});
  EXPECT_EQ(safety.trip(), GetParam().trip);
  EXPECT_TRUE(safety.justTripped());
  EXPECT_TRUE(isNothing(safety.step(force(3))));
  EXPECT_TRUE(isNothing(after(safety, 500, force(3), bad)));
  EXPECT_FALSE(safety.justTripped());
  EXPECT_EQ(safety.trips(), 1U);
  EXPECT_TRUE(isNothing(after(safety, 1000 + GetParam().comes_back_after, force(3))));
  EXPECT_EQ(safety.trip(), GetParam().trip);
  EXPECT_LT(after(safety, 1, force(3)).wrench.force_n.z(), 1e-5);
  EXPECT_TRUE(safety.justRecovered());
  EXPECT_EQ(safety.trip(), SafetyTrip::kNone);
  EXPECT_NEAR(after(safety, 999, force(3)).wrench.force_n.z(), 1.5, 0.01) << "half way through the soft start";
  EXPECT_NEAR(after(safety, 1001, force(3)).wrench.force_n.z(), 3, 1e-9);
}

constexpr auto kInf = std::numeric_limits<double>::infinity();
INSTANTIATE_TEST_SUITE_P(
    Of, Trips,
    testing::Values(
        Trip{"NoPosition", SafetyTrip::kDeviceNotFinite, [](DeviceInput& i) { i.pose.position_m.y() = kNaN; }},
        Trip{"EndlessPosition", SafetyTrip::kDeviceNotFinite, [](DeviceInput& i) { i.pose.position_m.z() = kInf; }},
        Trip{"NoOrientation", SafetyTrip::kDeviceNotFinite, [](DeviceInput& i) { i.pose.orientation.y() = kNaN; }},
        Trip{"EmptyOrientation", SafetyTrip::kDeviceNotFinite,
             [](DeviceInput& i) { i.pose.orientation.coeffs().setZero(); }},
        Trip{"NoVelocity", SafetyTrip::kDeviceNotFinite, [](DeviceInput& i) { i.twist.linear_m_s.x() = kNaN; }},
        Trip{"NoTurning", SafetyTrip::kDeviceNotFinite, [](DeviceInput& i) { i.twist.angular_rad_s.z() = -kInf; }},
        Trip{"NoGripper", SafetyTrip::kDeviceNotFinite, [](DeviceInput& i) { i.gripper_open = kNaN; }},
        Trip{"Stale", SafetyTrip::kStale, [](DeviceInput& i) { i.state = DeviceState::kStale; }},
        Trip{"Lost", SafetyTrip::kLost, [](DeviceInput& i) { i.state = DeviceState::kLost; }},
        Trip{"Workspace", SafetyTrip::kWorkspace, [](DeviceInput& i) { i.pose.position_m.x() = 0.21; }, 1},
        Trip{"Jump", SafetyTrip::kImplausible, [](DeviceInput& i) { i.pose.position_m.x() = 0.05; }, 1},
        Trip{"TurnedRound", SafetyTrip::kImplausible, [](DeviceInput& i) { i.pose.orientation = Quat(0, 1, 0, 0); }, 1},
        Trip{"Velocity", SafetyTrip::kImplausible, [](DeviceInput& i) { i.twist.linear_m_s.x() = 99; }, 1}),
    [](const testing::TestParamInfo<Trip>& test) { return std::string(test.param.name); });

TEST(SafetyLayer, BearsTwentyMissedDeadlinesInARowAndNoMore) {
  SafetyLayer safety = forPerson();
  for (int round = 0; round < 3; ++round) {
    for (int tick = 0; tick < 20; ++tick) {
      safety.check({}, {.late = true});
      ASSERT_EQ(safety.trip(), SafetyTrip::kNone);
    }
    safety.check({}, {});
  }
  for (int tick = 0; tick < 20; ++tick) {
    safety.check({}, {.late = true});
  }
  EXPECT_EQ(safety.trip(), SafetyTrip::kNone);
  safety.check({}, {.late = true});
  EXPECT_EQ(safety.trip(), SafetyTrip::kMissedDeadlines);
}

TEST(SafetyLayer, WithASimulatedHandTimeMayBeMissed) {
  SafetyLayer safety = forSimulation();
  for (int tick = 0; tick < 100; ++tick) {
    safety.check({}, {.late = true});
  }
  EXPECT_EQ(safety.trip(), SafetyTrip::kNone);
}

TEST(SafetyLayer, ALostHeartbeatIsATrip) {
  SafetyLayer safety = forPerson();
  safety.check({}, {.heartbeat_lost = true});
  EXPECT_EQ(safety.trip(), SafetyTrip::kHeartbeat);
}

TEST(SafetyLayer, AForceThatIsNoNumberIsATripAndReachesNobody) {
  for (const DeviceOutput& bad :
       {DeviceOutput{{Vec3(0, kNaN, 0), Vec3::Zero()}}, DeviceOutput{{Vec3(kInf, 0, 0), Vec3::Zero()}},
        DeviceOutput{{Vec3::Zero(), Vec3(0, 0, kNaN)}}, DeviceOutput{{}, kNaN}}) {
    SafetyLayer safety = forSimulation();
    (void)after(safety, 10, force(3));
    EXPECT_TRUE(isNothing(after(safety, 1, bad)));
    EXPECT_EQ(safety.trip(), SafetyTrip::kForceNotFinite);
    EXPECT_TRUE(safety.justTripped());
  }
}

TEST(SafetyLayer, ADeviceThatNobodyHasHeldYetIsNoTrip) {
  SafetyLayer safety = forPerson();
  DeviceInput stale;
  stale.state = DeviceState::kStale;
  EXPECT_TRUE(isNothing(after(safety, 100, force(3), stale)));
  EXPECT_FALSE(safety.justTripped());
  EXPECT_EQ(safety.trips(), 0U);
}

TEST(SafetyLayer, TheFirstReasonStaysAndIsTold) {
  SafetyLayer safety = forSimulation();
  (void)after(safety, 1, force(3));
  DeviceInput stale;
  stale.state = DeviceState::kStale;
  safety.check(stale, {});
  (void)safety.step(force(kNaN));  // follows from it
  EXPECT_EQ(safety.trip(), SafetyTrip::kStale);
  EXPECT_TRUE(safety.justTripped()) << "a second reason in the same tick does not hide that the first is new";
  EXPECT_EQ(safety.trips(), 1U);
}

TEST(SafetyLayer, ADeviceThatIsGoneIsGoneWhateverWasWrongBefore) {
  SafetyLayer safety = forSimulation();
  for (int tick = 0; tick < 10; ++tick) {
    safety.check({}, {});
  }
  DeviceInput told;
  told.state = DeviceState::kStale;
  safety.check(told, {});
  ASSERT_EQ(safety.trip(), SafetyTrip::kStale);
  told.state = DeviceState::kLost;
  safety.check(told, {});
  EXPECT_EQ(safety.trip(), SafetyTrip::kLost);
  EXPECT_EQ(safety.trips(), 1U);
}

TEST(SafetyLayer, TroubleThatComesBackDuringTheCalmStartsItAnew) {
  SafetyLayer safety = forSimulation();
  (void)after(safety, 1, force(3));
  DeviceInput stale;
  stale.state = DeviceState::kStale;
  (void)after(safety, 1, force(3), stale);
  (void)after(safety, 900, force(3));
  (void)after(safety, 1, force(3), stale);
  EXPECT_TRUE(isNothing(after(safety, 1000, force(3))));
  EXPECT_FALSE(isNothing(after(safety, 1, force(3))));
  EXPECT_EQ(safety.trips(), 1U);
}

TEST(SafetyLayer, RestartBeginsWithASoftStart) {
  SafetyLayer safety = forPerson();
  EXPECT_GT(after(safety, 2100, force(3)).wrench.force_n.z(), 2.9);
  safety.restart();
  EXPECT_LT(after(safety, 1, force(3)).wrench.force_n.z(), 1e-5);
  EXPECT_NEAR(after(safety, 999, force(3)).wrench.force_n.z(), 1.5, 0.01);
}

TEST(SafetyLayer, EnergyInExcessIsDampedOnlyWhenAskedFor) {
  for (const bool damps : {true, false}) {
    SafetyParameters parameters;
    parameters.passivity = damps;
    SafetyLayer safety = forSimulation(parameters);
    DeviceInput hand;
    (void)after(safety, 10, force(2), hand);
    hand.pose.position_m.z() += 1e-4;  // it yields: it was not pressed
    const double felt_n = after(safety, 1, force(2), hand).wrench.force_n.z();
    EXPECT_EQ((safety.flags() & kTickPassivityDamped) != 0, damps);
    EXPECT_EQ(felt_n < 2, damps);
    EXPECT_NEAR(safety.passivity().injected(), 2e-4, 1e-12) << "observed in any case";
  }
}

TEST(SafetyLayer, EveryTripHasAText) {
  std::set<std::string> texts;
  for (int trip = 0; trip <= static_cast<int>(SafetyTrip::kForceNotFinite); ++trip) {
    texts.insert(text(static_cast<SafetyTrip>(trip)));
  }
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(SafetyTrip::kForceNotFinite) + 1);
  EXPECT_EQ(texts.count(""), 0U);
}

TEST(SafetyLayer, RefusesNonsense) {
  const std::function<void(SafetyParameters&)> spoils[] = {
      [](SafetyParameters& s) { s.soft_start_s = -1; },
      [](SafetyParameters& s) { s.soft_start_s = kNaN; },
      [](SafetyParameters& s) { s.soft_start_s = 61; },
      [](SafetyParameters& s) { s.soft_stop_s = -1; },
      [](SafetyParameters& s) { s.soft_stop_s = 6; },
      [](SafetyParameters& s) { s.max_missed_deadlines = 0; },
      [](SafetyParameters& s) { s.max_missed_deadlines = 1001; },
      [](SafetyParameters& s) { s.watchdog_timeout_s = 1e-3; },
      [](SafetyParameters& s) { s.watchdog_timeout_s = kNaN; },
      [](SafetyParameters& s) { s.watchdog_timeout_s = 2; },
      [](SafetyParameters& s) { s.recovery_s = -0.1; },
      [](SafetyParameters& s) { s.max_force_n = -1; },
      [](SafetyParameters& s) { s.max_force_n = kNaN; },
      [](SafetyParameters& s) { s.max_torque_nm = 1001; },
  };
  int number = 0;
  for (const auto& spoil : spoils) {
    SafetyParameters parameters;
    spoil(parameters);
    EXPECT_THROW(forPerson(parameters), InvalidParameter) << number++;
  }
}

TEST(SafetyLayer, AToolTooHeavyForTheDeviceStaysWithinItsLimitsAndIsNotTakenForEnergy) {
  for (const auto& make : {forPerson, forSimulation}) {
    SafetyLayer safety = make({}, small());
    const Wrench weight{Vec3(0, 0, -5), Vec3(0.3, 0, 0)};
    for (int tick = 0; tick < 5000; ++tick) {
      DeviceInput input;
      input.pose.position_m.z() = 0.1 * std::sin(2 * 3.14159 * tick * kTick_s);
      safety.check(input, {});
      const DeviceOutput felt = safety.step({}, weight);
      ASSERT_LE(felt.wrench.force_n.norm(), small().max_force_n * (1 + 1e-12));
      ASSERT_LE(felt.wrench.torque_nm.norm(), small().max_torque_nm * (1 + 1e-12));
      ASSERT_EQ(safety.flags() & kTickPassivityDamped, 0U) << tick;
      if (tick > 3000) {
        ASSERT_NEAR(felt.wrench.force_n.z(), -small().max_force_n, 1e-12);
      }
    }
    EXPECT_LT(std::abs(safety.passivity().injected()), 1e-12);
  }
}

TEST(SafetyLayer, AWeightThatIsNoNumberLetsGo) {
  SafetyLayer safety = forSimulation();
  EXPECT_FALSE(isNothing(after(safety, 3, force(1))));
  EXPECT_TRUE(isNothing(safety.step(force(1), {Vec3(0, 0, kNaN), Vec3::Zero()})));
  EXPECT_EQ(safety.trip(), SafetyTrip::kForceNotFinite);
}

}  // namespace
}  // namespace haptolith
