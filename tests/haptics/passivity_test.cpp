#include "haptolith/haptics/safety/passivity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <functional>
#include <numbers>
#include <random>
#include <utility>

#include "haptolith/core/math/random.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;
constexpr double kStiffness_n_m = 500;

Pose at(double z_m) {
  return {Vec3(0, 0, z_m), Quat::Identity()};
}

Wrench force(double z_n) {
  return {Vec3(0, 0, z_n), Vec3::Zero()};
}

bool isZero(const Wrench& wrench) {
  return wrench.force_n == Vec3::Zero() && wrench.torque_nm == Vec3::Zero();
}

/// A handle on a damped spring of the hand's, and something at the handle that pushes.
struct Handle {
  double mass_kg = 0.5, stiffness_n_m = 200, damping_n_s_m = 1;
  double z_m = 0, speed_m_s = 0, given_j = 0;

  void move(double force_n, double wanted_m = 0) {
    const double from_m = z_m;
    speed_m_s += kTick_s / mass_kg * (stiffness_n_m * (wanted_m - z_m) - damping_n_s_m * speed_m_s + force_n);
    z_m += kTick_s * speed_m_s;
    given_j += force_n * (z_m - from_m);
  }
};

TEST(Passivity, CountsTheEnergyThatTheHandIsGiven) {
  Passivity passivity({.stiffness_n_m = kStiffness_n_m}, kTick_s);
  std::mt19937_64 random(7);
  const auto any = [&random] { return Vec3(uniformSigned(random), uniformSigned(random), uniformSigned(random)); };
  double expected_j = 0;
  Pose pose;
  Wrench sent{any(), any()};
  passivity.observe(pose, sent);
  for (int tick = 0; tick < 1000; ++tick) {
    const Vec3 step_m = 1e-3 * any();
    const Vec3 turn_rad = 1e-2 * any();
    pose.position_m += step_m;
    pose.orientation = Quat(Eigen::AngleAxisd(turn_rad.norm(), turn_rad.normalized())) * pose.orientation;
    sent = {any(), any()};  // since the last reading
    expected_j += sent.force_n.dot(step_m) + sent.torque_nm.dot(turn_rad);
    passivity.observe(pose, sent);
    ASSERT_NEAR(passivity.injected(), expected_j, 1e-9) << tick;
  }
}

TEST(Passivity, CountsADelayedForceAgainstTheMovementDuringWhichItIsShown) {
  for (const int delay : {0, 1, 5, 31}) {
    Passivity passivity({.stiffness_n_m = kStiffness_n_m, .delay_s = delay * kTick_s}, kTick_s);
    std::deque<double> on_the_way(static_cast<std::size_t>(delay), 0.0);
    double expected_j = 0, z_m = 0;
    passivity.observe(at(0), force(0));
    for (int tick = 1; tick < 500; ++tick) {
      const double sent_n = std::sin(0.3 * tick);
      on_the_way.push_back(sent_n);
      const double step_m = 1e-4 * std::cos(0.3 * tick);
      z_m += step_m;
      expected_j += on_the_way.front() * step_m;
      on_the_way.pop_front();
      passivity.observe(at(z_m), force(sent_n));
      ASSERT_NEAR(passivity.injected(), expected_j, 1e-12) << delay << " ticks of delay, tick " << tick;
    }
  }
}

TEST(Passivity, AllOfAForceThatIsShownAtOnceIsAffordable) {
  Passivity passivity({.stiffness_n_m = kStiffness_n_m}, kTick_s);
  passivity.observe(at(0), force(0));
  passivity.observe(at(0.001), force(0));
  EXPECT_EQ(passivity.affordable(force(100)), 1);
}

TEST(Passivity, AForceThatIsShownLateMustHaveBeenPaidFor) {
  Passivity passivity({.stiffness_n_m = kStiffness_n_m, .delay_s = 5 * kTick_s}, kTick_s);
  passivity.observe(at(0), force(0));
  EXPECT_EQ(passivity.affordable(force(0)), 1);
  // At rest, F = sqrt(2 m 0.5 mJ) / T with the lightest handle, 0.05 kg: 1.41 N.
  EXPECT_NEAR(passivity.affordable(force(8)), std::sqrt(2) / 8, 1e-12);
  EXPECT_EQ(passivity.affordable(force(1.4)), 1);
  passivity.observe(at(1e-4), force(0));  // 0.1 m/s: F T v + (F T)^2 / 2 m = 0.5 mJ
  const double shown_n = 8 * passivity.affordable(force(8));
  EXPECT_NEAR(5e-3 * shown_n * 0.1 + 5e-3 * shown_n * 5e-3 * shown_n / 0.1, 0.5e-3, 1e-12);
  for (int tick = 2; tick < 100; ++tick) {
    passivity.observe(at(1e-4 * tick), force(-4));  // the hand pays 0.4 mJ a tick
  }
  passivity.observe(at(1e-4 * 99), force(0));
  EXPECT_EQ(passivity.affordable(force(8)), 1);
}

/// Passive systems. Springs are swung at 0.2 m/s at most: of a faster swing the quick account
/// forgets a part before it comes back, and it forgives no more than soil stores.
struct Passive {
  const char* name;
  double fastest_m_s;
  std::function<double(double z_m, double speed_m_s)> force_n;
};

class PassiveThing : public testing::TestWithParam<Passive> {};

TEST_P(PassiveThing, IsLeftAloneBitForBit) {
  for (const double frequency_hz : {0.5, 2.0, 5.0, 9.0, 20.0}) {
    for (const double amplitude_m : {1e-4, 2e-3, 2e-2}) {
      if (2 * std::numbers::pi * frequency_hz * amplitude_m > GetParam().fastest_m_s) {
        continue;
      }
      Passivity passivity({.stiffness_n_m = kStiffness_n_m}, kTick_s);
      double before_m = 0, felt_n = 0, done_j = 0;
      for (int tick = 0; tick < 4000; ++tick) {
        const double angle = 2 * std::numbers::pi * frequency_hz * kTick_s * tick;
        const double z_m = -amplitude_m * std::min(1.0, tick / 500.0) * std::sin(angle);
        passivity.observe(at(z_m), force(felt_n));
        done_j += felt_n * (z_m - before_m);
        ASSERT_TRUE(isZero(passivity.damping()))
            << frequency_hz << " Hz, " << amplitude_m << " m, tick " << tick << ": " << done_j << " J";
        felt_n = std::clamp(GetParam().force_n(z_m, (z_m - before_m) / kTick_s), -12.0, 12.0);
        before_m = z_m;
      }
      EXPECT_LE(done_j, 0) << "it was not passive: this tells nothing";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, PassiveThing,
    testing::Values(Passive{"Damper", 10, [](double, double speed) { return -5 * speed; }},
                    Passive{"SpringAndDamper", 0.2, [](double z, double speed) { return -500 * z - 2 * speed; }},
                    Passive{"Wall", 0.2,
                            [](double z, double speed) { return z < 0 ? std::max(0.0, -500 * z - 2 * speed) : 0; }},
                    Passive{"DryFriction", 10, [](double, double speed) { return -2 * std::tanh(speed / 0.01); }},
                    Passive{"Nothing", 10, [](double, double) { return 0; }}),
    [](const testing::TestParamInfo<Passive>& test) { return std::string(test.param.name); });

TEST(Passivity, ForceThatNobodyHasPressedForIsTakenBack) {
  Passivity passivity({.stiffness_n_m = kStiffness_n_m}, kTick_s);
  passivity.observe(at(0), force(1));
  passivity.observe(at(1e-4), force(1));  // 0.1 mJ in a millisecond, at 0.1 m/s
  const Wrench damping = passivity.damping();
  EXPECT_LT(damping.force_n.z(), 0) << "against the movement";
  EXPECT_NEAR(damping.force_n.z(), -1, 1e-9) << "E / (dt v^2) v: as much as was given";
}

TEST(Passivity, TheDamperIsNoStrongerThanADelayedOutputBears) {
  Passivity passivity({.stiffness_n_m = kStiffness_n_m}, kTick_s);
  passivity.observe(at(0), force(12));
  passivity.observe(at(1e-4), force(12));
  EXPECT_LE(passivity.damping().force_n.norm(), 2 * 20 * 0.1 + 1e-9) << "20 N s/m, in each of the two accounts";
  EXPECT_GE(passivity.damping().force_n.norm(), 20 * 0.1 - 1e-9);
}

TEST(Passivity, TurningIsDampedLikeMoving) {
  Passivity passivity({.stiffness_n_m = kStiffness_n_m}, kTick_s);
  const Wrench torque{Vec3::Zero(), Vec3(0, 0.1, 0)};
  passivity.observe({}, torque);
  passivity.observe({Vec3::Zero(), Quat(Eigen::AngleAxisd(1e-3, Vec3::UnitY()))}, torque);
  EXPECT_NEAR(passivity.injected(), 1e-4, 1e-9);
  EXPECT_LT(passivity.damping().torque_nm.y(), -1e-3);
  EXPECT_EQ(passivity.damping().force_n, Vec3::Zero());
}

/// A push that follows the handle's speed: the plainest of what is active.
double shaken(bool damped, int delay, double* largest_m) {
  Passivity passivity({.stiffness_n_m = kStiffness_n_m, .delay_s = delay * kTick_s}, kTick_s);
  Handle handle;
  handle.speed_m_s = 0.02;
  std::deque<double> on_the_way(static_cast<std::size_t>(delay), 0.0);
  double sent_n = 0;
  double since_m = 0;
  for (int tick = 0; tick < 6000; ++tick) {
    passivity.observe(at(handle.z_m), force(sent_n));
    sent_n = std::clamp(3 * handle.speed_m_s, -12.0, 12.0);
    if (damped) {
      sent_n = std::clamp(sent_n + passivity.damping().force_n.z(), -12.0, 12.0);
    }
    on_the_way.push_back(sent_n);
    handle.move(on_the_way.front());
    on_the_way.pop_front();
    since_m = tick < 4000 ? 0 : std::max(since_m, std::abs(handle.z_m));
  }
  *largest_m = since_m;
  return handle.given_j;
}

TEST(Passivity, WhatIsActiveIsDamped) {
  for (const int delay : {0, 2, 5}) {
    double off_m = 0, on_m = 0;
    const double off_j = shaken(false, delay, &off_m);
    const double on_j = shaken(true, delay, &on_m);
    EXPECT_GT(off_m, 0.05) << "without the controller the handle is shaken ever harder";
    EXPECT_GT(off_j, 0.1);
    EXPECT_LT(on_m, 1e-4);
    EXPECT_LT(on_j, 1e-3);
  }
}

TEST(Passivity, ShakingIsDampedHoweverMuchHasBeenDissipatedBefore) {
  Passivity passivity({.stiffness_n_m = kStiffness_n_m}, kTick_s);
  double z_m = 0, felt_n = 0;
  for (int tick = 0; tick < 3000; ++tick) {  // digging: 5 N against 0.1 m/s
    passivity.observe(at(z_m), force(felt_n));
    z_m += 1e-4;
    felt_n = -5;
  }
  EXPECT_LT(passivity.injected(), -1.4);
  int first_damped = -1;
  double given_j = 0;
  for (int tick = 0; tick < 1000 && first_damped < 0; ++tick) {  // then it shakes: 2 N with 20 Hz, with the speed
    const double angle = 2 * std::numbers::pi * 20 * kTick_s * tick;
    z_m += 2e-4 * std::sin(angle);
    felt_n = 2 * std::sin(angle);
    passivity.observe(at(z_m), force(felt_n));
    given_j += 2e-4 * std::sin(angle) * felt_n;
    first_damped = isZero(passivity.damping()) || tick < 20 ? -1 : tick;
  }
  EXPECT_GT(first_damped, 0);
  EXPECT_LT(given_j, 0.02) << "the whole account would have borne 1.5 J";
}

TEST(Passivity, RestartForgetsWhereTheHandleWasAndWhatWasOnTheWay) {
  Passivity passivity({.stiffness_n_m = kStiffness_n_m, .delay_s = 5 * kTick_s}, kTick_s);
  for (int tick = 0; tick < 10; ++tick) {
    passivity.observe(at(0), force(5));
  }
  passivity.restart();
  const double before_j = passivity.injected();
  for (int tick = 0; tick < 20; ++tick) {
    passivity.observe(at(0.1 + 1e-3 * tick), force(0));
  }
  EXPECT_EQ(passivity.injected(), before_j);
}

TEST(Passivity, AJumpBeforeARestartIsForgotten) {
  Passivity passivity({.stiffness_n_m = kStiffness_n_m}, kTick_s);
  passivity.observe(at(0), force(1));
  passivity.observe(at(1), force(1));  // a metre in a millisecond
  EXPECT_FALSE(isZero(passivity.damping()));
  passivity.restart();
  EXPECT_TRUE(isZero(passivity.damping()));
  for (int tick = 0; tick < 100; ++tick) {
    passivity.observe(at(0), force(0));
    ASSERT_TRUE(isZero(passivity.damping())) << tick;
  }
}

TEST(Passivity, NobodyMovesNobodyIsDamped) {
  Passivity passivity({.stiffness_n_m = kStiffness_n_m}, kTick_s);
  for (int tick = 0; tick < 100; ++tick) {
    passivity.observe(at(0.03), force(12));
    ASSERT_TRUE(isZero(passivity.damping()));
  }
  EXPECT_EQ(passivity.injected(), 0);
}

/// A handle with quantised positions, pressed at rest against something stiff that responds to each step a tick
/// later.
Passivity atRestFor(double seconds, double step_m, double noise_m, double resolution_m) {
  Passivity passivity({.stiffness_n_m = kStiffness_n_m, .resolution_m = resolution_m}, kTick_s);
  std::mt19937_64 random(3);
  double felt_n = 3;
  for (int tick = 0; tick < seconds / kTick_s; ++tick) {
    // Reading of a handle between two steps: on either side of them.
    const double told_m = step_m * (uniformSigned(random) > 0 ? 1 : 0) + noise_m * uniformSigned(random);
    passivity.observe(at(told_m), force(felt_n));
    felt_n = 3 - 1400 * told_m;
  }
  return passivity;
}

TEST(Passivity, AHandleAtRestDoesNoWorkHoweverItsPositionIsTold) {
  for (const auto& [step_m, noise_m] : {std::pair{2e-5, 0.0}, std::pair{6e-5, 0.0}, std::pair{0.0, 1e-4}}) {
    const Passivity coarse = atRestFor(60, step_m, noise_m, 1e-4);
    const double at_first_j =
        atRestFor(5, step_m, noise_m, 1e-4).injected();  // until the dead band lies about the noise
    EXPECT_NEAR(at_first_j, 0, 0.5e-3) << step_m << " " << noise_m;
    EXPECT_NEAR(coarse.injected(), at_first_j, 0.02e-3) << step_m << " " << noise_m;
    EXPECT_TRUE(isZero(coarse.damping()));
    EXPECT_EQ(coarse.softening(), 1);
    // Taken for exact, the same positions make energy out of nothing: or this could not fail.
    EXPECT_GT(atRestFor(60, step_m, noise_m, 0).injected(), 5e-3) << step_m << " " << noise_m;
  }
}

TEST(Passivity, MeasuresNoiseThatADeviceHasNotDeclared) {
  EXPECT_NEAR(atRestFor(60, 0, 3e-4, 1e-4).injected(), atRestFor(5, 0, 3e-4, 1e-4).injected(), 0.02e-3);
}

/// A handle that swings at 30 Hz against a spring, at a device that shows forces up to so late.
Passivity shakenFor(double seconds, double declared_s) {
  Passivity passivity(
      {.stiffness_n_m = kStiffness_n_m, .delay_s = declared_s, .delay_known = false, .resolution_m = 1e-5}, kTick_s);
  for (int tick = 0; tick < seconds / kTick_s; ++tick) {
    const double angle = 2 * std::numbers::pi * 30 * kTick_s * tick;
    passivity.observe(at(0.5e-3 * std::sin(angle)), force(1 - 0.5 * std::sin(angle)));
  }
  return passivity;
}

TEST(Passivity, ShakingTakesTheForceAwayWhicheverDelayTheDeviceHas) {
  // A spring that is shown without delay gives nothing; if it may be shown up to 10 ms late, it may shake a hand.
  EXPECT_EQ(shakenFor(3, 0).softening(), 1);
  const double softening = shakenFor(3, 0.01).softening();
  EXPECT_LT(softening, 0.5);
  EXPECT_GT(softening, 0);
}

TEST(Passivity, ForceComesBackWhenShakingIsOver) {
  Passivity passivity = shakenFor(3, 0.01);
  for (int tick = 0; tick < 60'000; ++tick) {
    passivity.observe(at(0), force(1));
  }
  EXPECT_GT(passivity.softening(), 0.95);
}

TEST(Passivity, ARestartDoesNotForgetThatAHandWasShaken) {
  Passivity passivity = shakenFor(3, 0.01);
  const double softening = passivity.softening();
  passivity.restart();
  EXPECT_EQ(passivity.softening(), softening);
}

}  // namespace
}  // namespace haptolith
