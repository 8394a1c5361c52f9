#include "haptolith/device/mapping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/core/math/random.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;
const Vec3 kCentre_m(0.01, -0.02, 0.03);

DeviceLimits centred() {
  DeviceLimits limits;
  limits.workspace_centre_m = kCentre_m;
  return limits;
}

/// As different from the default as can be.
MappingParameters crooked() {
  MappingParameters mapping;
  mapping.offset_m = {0.4, -0.3, 0.2};
  mapping.turn_rad = {0.5, -1.1, 2.3};
  mapping.scale = 2.5;
  mapping.force_scale = 0.4;
  mapping.clutch_button = 3;
  return mapping;
}

DeviceInput handAt(const Vec3& position_m, double angle_rad = 0, bool clutch = false) {
  DeviceInput input;
  input.pose = {position_m, Quat(Eigen::AngleAxisd(angle_rad, Vec3(0.6, 0, 0.8)))};
  input.twist = {Vec3(0.3, -0.2, 0.1), Vec3(1, 2, -3)};
  input.buttons = clutch ? 1U << 3U : 1U << 2U;  // another button has no effect
  return input;
}

/// A hand that wanders about.
DeviceInput wandering(int tick, bool clutch) {
  const double t_s = kTick_s * tick;
  return handAt(0.05 * Vec3(std::sin(3 * t_s), std::cos(2 * t_s), std::sin(5 * t_s)), std::sin(4 * t_s), clutch);
}

double angleBetween(const Quat& a, const Quat& b) {
  return 2 * std::acos(std::min(1.0, std::abs(a.dot(b))));
}

TEST(Mapping, ByDefaultIsNone) {
  Mapping mapping({}, {}, kTick_s);
  const DeviceInput hand = handAt({0.1, 0.2, 0.3}, 0.7);
  const Movement tool = mapping.toScene(hand);
  EXPECT_EQ(tool.pose.position_m, hand.pose.position_m);
  EXPECT_LT(angleBetween(tool.pose.orientation, hand.pose.orientation), 1e-7);
  EXPECT_EQ(tool.twist.linear_m_s, hand.twist.linear_m_s);
  EXPECT_EQ(tool.twist.angular_rad_s, hand.twist.angular_rad_s);
  const Wrench felt = mapping.toDevice({{Vec3(1, 2, 3), Vec3(4, 5, 6)}}).wrench;
  EXPECT_EQ(felt.force_n, Vec3(1, 2, 3));
  EXPECT_EQ(felt.torque_nm, Vec3(4, 5, 6));
}

TEST(Mapping, IsTheEquationWithMatrices) {
  const MappingParameters parameters = crooked();
  Mapping mapping(parameters, centred(), kTick_s);
  const auto about = [](double angle, const Vec3& axis) { return Eigen::AngleAxisd(angle, axis).toRotationMatrix(); };
  const Eigen::Matrix3d turn = about(2.3, Vec3::UnitZ()) * about(-1.1, Vec3::UnitY()) * about(0.5, Vec3::UnitX());
  const DeviceInput hand = handAt({0.05, 0.06, -0.07}, 0.9);
  const Movement tool = mapping.toScene(hand);
  const Vec3 expected = parameters.offset_m + 2.5 * turn * (hand.pose.position_m - kCentre_m);
  EXPECT_LT((tool.pose.position_m - expected).norm(), 1e-14);
  const Eigen::Matrix3d turned = turn * hand.pose.orientation.toRotationMatrix() * turn.transpose();
  EXPECT_LT((tool.pose.orientation.toRotationMatrix() - turned).norm(), 1e-14);
  EXPECT_LT((tool.twist.linear_m_s - 2.5 * turn * hand.twist.linear_m_s).norm(), 1e-14);
  EXPECT_LT((tool.twist.angular_rad_s - turn * hand.twist.angular_rad_s).norm(), 1e-14);
  const Wrench soil{Vec3(1, -2, 3), Vec3(0.1, 0.2, -0.3)};
  const Wrench felt = mapping.toDevice({soil}).wrench;
  EXPECT_LT((felt.force_n - 0.4 * turn.transpose() * soil.force_n).norm(), 1e-14);
  EXPECT_LT((felt.torque_nm - 0.4 / 2.5 * turn.transpose() * soil.torque_nm).norm(), 1e-14);
  const Wrench shown = mapping.turnedIntoScene(felt);
  EXPECT_LT((shown.force_n - 0.4 * soil.force_n).norm(), 1e-14) << "as large as at the device";
}

TEST(Mapping, TheMiddleOfTheWorkspaceIsWhereTheOffsetPutsIt) {
  Mapping mapping(crooked(), centred(), kTick_s);
  EXPECT_LT((mapping.toScene(handAt(kCentre_m)).pose.position_m - crooked().offset_m).norm(), 1e-15);
}

TEST(Mapping, VelocityIsTheRateOfThePose) {
  Mapping mapping(crooked(), centred(), kTick_s);
  const double step_s = 1e-6;
  DeviceInput hand = handAt({0.02, 0.01, 0.05}, 0.4);
  const Movement now = mapping.toScene(hand);
  hand.pose.position_m += step_s * hand.twist.linear_m_s;
  hand.pose.orientation =
      Quat(Eigen::AngleAxisd(step_s * hand.twist.angular_rad_s.norm(), hand.twist.angular_rad_s.normalized())) *
      hand.pose.orientation;
  const Movement then = mapping.toScene(hand);
  EXPECT_LT(((then.pose.position_m - now.pose.position_m) / step_s - now.twist.linear_m_s).norm(), 1e-6);
  const Vec3 turned = rotationBetween(now.pose.orientation, then.pose.orientation) / step_s;
  EXPECT_LT((turned - now.twist.angular_rad_s).norm(), 1e-6);
}

TEST(Mapping, PowerIsTheSameOnBothSidesWhereForcesAreScaledAsLengths) {
  std::mt19937_64 random(1);
  const auto any = [&random] { return Vec3(uniformSigned(random), uniformSigned(random), uniformSigned(random)); };
  for (const double ratio : {1.0, 0.25, 4.0}) {
    for (int i = 0; i < 100; ++i) {
      MappingParameters parameters;
      parameters.turn_rad = 3 * any();
      parameters.scale = std::pow(10, uniformSigned(random));
      parameters.force_scale = ratio * parameters.scale;
      Mapping mapping(parameters, centred(), kTick_s);
      DeviceInput hand = handAt(any());
      hand.twist = {any(), any()};
      const Twist tool = mapping.toScene(hand).twist;
      const Wrench soil{any(), any()};
      const Wrench felt = mapping.toDevice({soil}).wrench;
      const double in_scene_w = soil.force_n.dot(tool.linear_m_s) + soil.torque_nm.dot(tool.angular_rad_s);
      const double at_device_w = felt.force_n.dot(hand.twist.linear_m_s) + felt.torque_nm.dot(hand.twist.angular_rad_s);
      ASSERT_NEAR(at_device_w, ratio * in_scene_w, 1e-12 * (1 + std::abs(at_device_w) + std::abs(in_scene_w)) * 10);
    }
  }
}

TEST(Mapping, TheToolNeverJumpsThroughAClutch) {
  Mapping mapping(crooked(), centred(), kTick_s);
  Movement last = mapping.toScene(wandering(0, false));
  const double per_tick_m =
      2.5 * 0.05 * 7 * kTick_s;  // scale * amplitude * the sum of the frequencies is more than enough
  double widest_m = 0;
  for (int tick = 1; tick < 4000; ++tick) {
    const bool clutch = tick / 500 % 2 == 1;
    const Movement now = mapping.toScene(wandering(tick, clutch));
    ASSERT_LT((now.pose.position_m - last.pose.position_m).norm(), per_tick_m) << tick;
    ASSERT_LT(angleBetween(now.pose.orientation, last.pose.orientation), 6e-3) << tick;
    ASSERT_NEAR(now.pose.orientation.norm(), 1, 1e-12);
    if (clutch) {
      ASSERT_EQ(now.pose.position_m, last.pose.position_m);
      ASSERT_EQ(now.twist.linear_m_s, Vec3::Zero());
      ASSERT_EQ(now.twist.angular_rad_s, Vec3::Zero());
    }
    Mapping straight(crooked(), centred(), kTick_s);
    widest_m =
        std::max(widest_m, (straight.toScene(wandering(tick, false)).pose.position_m - now.pose.position_m).norm());
    last = now;
  }
  EXPECT_GT(widest_m, 0.02) << "the clutch has moved the tool to where the hand alone would not have come";
}

TEST(Mapping, AClutchThatIsHeldFromTheFirstTickLeavesTheToolWhereTheHandBegan) {
  Mapping mapping(crooked(), centred(), kTick_s);
  Mapping other(crooked(), centred(), kTick_s);
  const Pose wanted = other.toScene(wandering(0, false)).pose;
  EXPECT_EQ(mapping.toScene(wandering(0, true)).pose.position_m, wanted.position_m);
  EXPECT_EQ(mapping.toDevice({{Vec3(1, 1, 1), Vec3(1, 1, 1)}}).wrench.force_n, Vec3::Zero());
  for (int tick = 1; tick < 300; ++tick) {
    ASSERT_EQ(mapping.toScene(wandering(tick, true)).pose.position_m, wanted.position_m);
  }
  EXPECT_LT((mapping.toScene(wandering(300, false)).pose.position_m - wanted.position_m).norm(), 1e-12);
}

TEST(Mapping, TheHandFeelsNothingThroughAClutchAndForceComesBackWithinAFifthOfASecond) {
  Mapping mapping(crooked(), centred(), kTick_s);
  const Wrench soil{Vec3(0, 0, 10), Vec3(0, 1, 0)};
  (void)mapping.toScene(wandering(0, false));
  EXPECT_NEAR(mapping.toDevice({soil}).wrench.force_n.norm(), 4, 1e-12);
  (void)mapping.toScene(wandering(1, true));
  EXPECT_EQ(mapping.toDevice({soil}).wrench.force_n, Vec3::Zero());
  EXPECT_EQ(mapping.toDevice({soil}).wrench.torque_nm, Vec3::Zero());
  double last_n = 0;
  for (int tick = 2; tick < 202; ++tick) {
    (void)mapping.toScene(wandering(tick, false));
    const double now_n = mapping.toDevice({soil}).wrench.force_n.norm();
    ASSERT_NEAR(now_n - last_n, 4.0 / 200, 1e-9) << tick;
    last_n = now_n;
  }
  EXPECT_NEAR(last_n, 4, 1e-9);
}

TEST(Mapping, WithoutAClutchButtonNoButtonHoldsTheTool) {
  MappingParameters parameters = crooked();
  parameters.clutch_button = -1;
  Mapping mapping(parameters, centred(), kTick_s);
  DeviceInput hand = handAt({0, 0, 0});
  hand.buttons = 0xffffffffU;
  const Vec3 before = mapping.toScene(hand).pose.position_m;
  hand.pose.position_m.x() += 0.1;
  EXPECT_NEAR((mapping.toScene(hand).pose.position_m - before).norm(), 0.25, 1e-12);
}

TEST(Mapping, WhatIsRightAndAwayForAPersonIsSoInTheSceneWhateverAxesTheDeviceHas) {
  DeviceLimits device;
  device.turn_rad = {0, 0, -std::numbers::pi / 2};  // x to the person, y to the right
  Mapping mapping({}, device, kTick_s);
  EXPECT_LT((mapping.toScene(handAt({0, 0.1, 0})).pose.position_m - Vec3(0.1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((mapping.toScene(handAt({-0.1, 0, 0})).pose.position_m - Vec3(0, 0.1, 0)).norm(), 1e-15);
  EXPECT_LT((mapping.toDevice({{Vec3(1, 0, 0), Vec3::Zero()}}).wrench.force_n - Vec3(0, 1, 0)).norm(), 1e-15);
}

TEST(Mapping, RefusesNonsense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::function<void(MappingParameters&)> spoils[] = {
      [=](MappingParameters& m) { m.offset_m.y() = nan; }, [](MappingParameters& m) { m.offset_m.z() = 10.1; },
      [](MappingParameters& m) { m.turn_rad.x() = 8; },    [=](MappingParameters& m) { m.turn_rad.z() = nan; },
      [](MappingParameters& m) { m.scale = 0; },           [](MappingParameters& m) { m.scale = -1; },
      [=](MappingParameters& m) { m.scale = nan; },        [](MappingParameters& m) { m.scale = 101; },
      [](MappingParameters& m) { m.force_scale = -0.1; },  [](MappingParameters& m) { m.force_scale = 101; },
      [=](MappingParameters& m) { m.force_scale = nan; },  [](MappingParameters& m) { m.clutch_button = 32; },
      [](MappingParameters& m) { m.clutch_button = -2; },
  };
  int number = 0;
  for (const auto& spoil : spoils) {
    MappingParameters parameters = crooked();
    spoil(parameters);
    EXPECT_THROW((Mapping{parameters, centred(), kTick_s}), InvalidParameter) << number++;
  }
  EXPECT_NO_THROW((Mapping{crooked(), centred(), kTick_s}));
}

}  // namespace
}  // namespace haptolith
