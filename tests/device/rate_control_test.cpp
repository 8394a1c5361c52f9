#include "haptolith/device/drivers/rate_control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/core/math/random.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Vec3 anyVector(std::mt19937_64& random) {
  return {uniformSigned(random), uniformSigned(random), uniformSigned(random)};
}

Vec3 speedAt(const Vec3& linear, const RateParameters& rate = {}) {
  return rateOf({.linear = linear}, rate).linear_m_s;
}

TEST(RateOf, FullDeflectionGivesTheLargestSpeedAndMoreGivesNoMore) {
  const RateParameters rate{.dead_zone = 0.2, .max_speed_m_s = 0.3, .max_turn_rad_s = 2};
  for (const double size : {1.0, 1.5, 1e9}) {
    const Twist speed = rateOf({.linear = {0, -size, 0}, .angular = {size, 0, 0}}, rate);
    EXPECT_NEAR(speed.linear_m_s.y(), -0.3, 1e-12);
    EXPECT_NEAR(speed.angular_rad_s.x(), 2, 1e-12);
  }
}

TEST(RateOf, IsTheEquationBetweenDeadZoneAndFullDeflection) {
  // Half the way from a dead zone of 0.2 to 1: a quarter of the speed.
  EXPECT_NEAR(speedAt({0.6, 0, 0}, {.dead_zone = 0.2, .max_speed_m_s = 1}).x(), 0.25, 1e-12);
}

TEST(RateOf, TheDeadZoneIsRestInEveryDirection) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(speedAt(0.1 * anyVector(random).normalized() * (1 - 1e-12)), Vec3::Zero());
  }
  EXPECT_GT(speedAt({0.11, 0, 0}).x(), 0);
}

TEST(RateOf, BeginsAndGoesOnWithoutJumpsAndNeverFalls) {
  double before = 0;
  for (double deflection = 0; deflection <= 1.2; deflection += 1e-4) {
    const double speed = speedAt({deflection, 0, 0}, {.max_speed_m_s = 1}).x();
    EXPECT_GE(speed, before - 1e-15);
    EXPECT_LT(speed - before, 3e-4);
    before = speed;
  }
}

TEST(RateOf, TurnsWithTheDeflectionAndIsOdd) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 push = anyVector(random);
    const Quat turn = turnedBy(3 * anyVector(random), Quat::Identity());
    EXPECT_NEAR((speedAt(turn * push) - turn * speedAt(push)).norm(), 0, 1e-12);
    EXPECT_EQ(speedAt(-push), -speedAt(push));
  }
}

TEST(RateOf, RubbishIsRest) {
  for (const double rubbish : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_EQ(speedAt({rubbish, 0.5, 0}), Vec3::Zero());
  }
}

TEST(SteeredHandle, GoesAsFastAsItIsDriven) {
  SteeredHandle handle(kTick_s);
  const Twist speed{.linear_m_s = {0.03, -0.02, 0.01}, .angular_rad_s = {0, 0, 0.5}};
  Movement now;
  for (int i = 0; i < 1000; ++i) {
    now = handle.drive(speed);
  }
  EXPECT_NEAR((now.twist.linear_m_s - speed.linear_m_s).norm(), 0, 1e-9);
  EXPECT_NEAR((now.twist.angular_rad_s - speed.angular_rad_s).norm(), 0, 1e-9);
  // One second on its way, less what it lags behind.
  EXPECT_NEAR((now.pose.position_m - (1 - SteeredHandle::kSmoothing_s) * speed.linear_m_s).norm(), 0, 1e-4);
  for (int i = 0; i < 1000; ++i) {
    now = handle.drive({});
  }
  EXPECT_NEAR((now.pose.position_m - speed.linear_m_s).norm(), 0, 1e-12);
  EXPECT_NEAR((rotationBetween(Quat::Identity(), now.pose.orientation) - speed.angular_rad_s).norm(), 0, 1e-12);
}

TEST(SteeredHandle, TheTwistIsThePosesStepDividedByTheTick) {
  std::mt19937_64 random(3);
  SteeredHandle handle(kTick_s);
  Movement before = handle.drive({});
  for (int i = 0; i < 20'000; ++i) {  // into the wall, along it and back, with pushes of a mouse between
    const Vec3 push = anyVector(random);
    const Movement now = i % 7 == 0 ? handle.displace(0.05 * push)
                                    : handle.drive({.linear_m_s = push, .angular_rad_s = 3 * anyVector(random)});
    EXPECT_NEAR((before.pose.position_m + kTick_s * now.twist.linear_m_s - now.pose.position_m).norm(), 0, 1e-15);
    const Quat turned = turnedBy(kTick_s * now.twist.angular_rad_s, before.pose.orientation);
    EXPECT_NEAR(rotationBetween(turned, now.pose.orientation).norm(), 0, 1e-14);
    EXPECT_NEAR(now.pose.orientation.norm(), 1, 1e-14);
    before = now;
  }
}

TEST(SteeredHandle, NeverLeavesItsWorkspaceAndSlidesAlongItsWall) {
  SteeredHandle handle(kTick_s, 0.1);
  Movement now;
  for (int i = 0; i < 3000; ++i) {
    now = handle.drive({.linear_m_s = {0.5, 0.1, 0}});
    EXPECT_LE(now.pose.position_m.norm(), 0.1 + 1e-15);
  }
  EXPECT_NEAR(now.pose.position_m.norm(), 0.1, 1e-9);
  const Vec3 direction = now.pose.position_m.normalized();
  EXPECT_NEAR((direction - Vec3(0.5, 0.1, 0).normalized()).norm(), 0, 1e-3);
  // Back from the wall at once: what was pushed against it is not owed.
  now = handle.drive({.linear_m_s = {-0.5, 0, 0}});
  EXPECT_LT(now.twist.linear_m_s.x(), 0);
}

TEST(SteeredHandle, IsDisplacedByWhatItIsPushedNoMoreAndNoLess) {
  SteeredHandle handle(kTick_s);
  std::mt19937_64 random(4);
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < 500; ++i) {
    const Vec3 push = 2e-3 * anyVector(random);
    sum += push;
    handle.displace(push);
  }
  ASSERT_LT(sum.norm(), 0.1);
  Movement now;
  for (int i = 0; i < 1000; ++i) {
    now = handle.displace(Vec3::Zero());
  }
  EXPECT_NEAR((now.pose.position_m - sum).norm(), 0, 1e-12);
  EXPECT_EQ(now.pose.orientation.coeffs(), Quat::Identity().coeffs());
}

TEST(SteeredHandle, AtRestNothingDriftsNotEvenByABit) {
  SteeredHandle handle(kTick_s);
  for (int i = 0; i < 200; ++i) {
    handle.drive({.linear_m_s = {0.1, 0.02, -0.07}, .angular_rad_s = {1, 0.3, -0.2}});
  }
  Movement rest;
  for (int i = 0; i < 1000; ++i) {
    rest = handle.drive({});
  }
  for (int i = 0; i < 10'000; ++i) {
    const Movement now = handle.drive(rateOf({.linear = {0.05, 0.05, 0}, .angular = {0, 0.09, 0}}, {}));
    ASSERT_EQ(now.pose.position_m, rest.pose.position_m);
    ASSERT_EQ(now.pose.orientation.coeffs(), rest.pose.orientation.coeffs());
    ASSERT_EQ(now.twist.linear_m_s, Vec3::Zero());
    ASSERT_EQ(now.twist.angular_rad_s.norm(), 0);
  }
}

TEST(SteeredHandle, NoPushIsFasterThanTheLargestSpeed) {
  SteeredHandle handle(kTick_s);
  double fastest = 0;
  handle.displace({1e6, 0, 0});
  for (int i = 0; i < 300; ++i) {
    fastest = std::max(fastest, handle.displace(i == 100 ? Vec3(0, 0, -1e300) : Vec3::Zero()).twist.linear_m_s.norm());
  }
  EXPECT_LE(fastest, SteeredHandle::kMaxSpeed_m_s * (1 + 1e-9));
  EXPECT_GT(fastest, 0.9 * SteeredHandle::kMaxSpeed_m_s);
}

TEST(SteeredHandle, RubbishMovesNothing) {
  SteeredHandle handle(kTick_s);
  for (const double rubbish : {kNaN, kInfinity, -kInfinity}) {
    const Movement now = handle.displace({0, rubbish, 0});
    EXPECT_EQ(now.pose.position_m, Vec3::Zero());
    EXPECT_EQ(now.twist.linear_m_s, Vec3::Zero());
  }
}

TEST(SteeredHandle, RefusesATickOrAWorkspaceThatIsNone) {
  EXPECT_THROW(SteeredHandle(0), InvalidParameter);
  EXPECT_THROW(SteeredHandle(1), InvalidParameter);
  EXPECT_THROW(SteeredHandle{kNaN}, InvalidParameter);
  EXPECT_THROW(SteeredHandle(kTick_s, 0), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
