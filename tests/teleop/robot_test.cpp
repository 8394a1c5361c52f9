#include "haptolith/teleop/robot/robot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;
constexpr std::uint64_t kPeriod = 20;
const Pose kHome{{0, 0, 0.085}, Quat::Identity()};

/// A robot over a bed, and an operator who sends what `hand` does, as long as the link lets it.
class RobotOverSoil : public testing::Test {
 protected:
  static BedParameters smallBed() {
    BedParameters bed;
    bed.soil.friction = FrictionModel::kContact;
    return bed;
  }

  void SetUp() override { begin({}); }

  void begin(RobotParameters parameters) {
    parameters.sensor.noise_n = parameters.sensor.noise_nm = 0;
    scene_.emplace(smallBed(), ToolParameters());
    robot_.emplace(parameters, *scene_, scene_->bed().surfaceHeight(), kHome);
  }

  /// Pose of the hand: at home, or displaced by a test.
  static Keyframe at(std::uint64_t index, const Vec3& position_m, const Vec3& velocity_m_s = Vec3::Zero()) {
    Keyframe key;
    key.index = index;
    key.hand.pose.position_m = position_m;
    key.hand.twist.linear_m_s = velocity_m_s;
    return key;
  }
  /// Down into the soil and to and fro in it, from the 2nd second on.
  static Keyframe digging(std::uint64_t index) {
    const double t = static_cast<double>(index) * kTick_s;
    const double down = std::min(1.0, std::max(0.0, t - 2));
    const double s = down * down * (3 - 2 * down);
    const double ds = down > 0 && down < 1 ? 6 * down * (1 - down) : 0;
    const double w = 2;
    return at(index, {0.02 * s * std::sin(w * t), 0, 0.085 - 0.095 * s},
              {0.02 * (ds * std::sin(w * t) + s * w * std::cos(w * t)), 0, -0.095 * ds});
  }

  template <class Hand>
  void run(double duration_s, Hand&& hand, bool link = true, bool held = true) {
    for (const auto end = static_cast<std::uint64_t>(std::llround(duration_s / kTick_s)) + now_; now_ < end; ++now_) {
      if (link && now_ % kPeriod == 0) {
        robot_->take(connection_, held, std::vector{hand(now_ - begun_)});
      }
      robot_->tick();
      if (robot_->state() == RobotState::kFollowing) {
        const Vec3 wanted = hand(static_cast<std::uint64_t>(robot_->index())).hand.pose.position_m;
        furthest_m_ = std::max(furthest_m_, (robot_->tool().pose.position_m - wanted).norm());
      }
    }
  }
  void expectAtRest() { EXPECT_LT(robot_->tool().twist.linear_m_s.norm(), 1e-3); }

  std::optional<Scene> scene_;
  std::optional<Robot> robot_;
  std::uint32_t connection_ = 1;
  std::uint64_t now_ = 0, begun_ = 0;
  double furthest_m_ = 0;
};

TEST_F(RobotOverSoil, TaresThenFollowsWithinAMillimetreInTheAirAndThreeInSoil) {
  run(0.4, digging);
  EXPECT_EQ(robot_->state(), RobotState::kTaring);
  run(1, digging);
  EXPECT_EQ(robot_->state(), RobotState::kFollowing);
  EXPECT_LT(furthest_m_, 1e-3);
  run(6, digging);
  EXPECT_EQ(robot_->state(), RobotState::kFollowing);
  EXPECT_LT(furthest_m_, 3e-3);
  EXPECT_GT(scene_->soilWrench().force_n.norm(), 0.02) << "it digs";
  EXPECT_EQ(robot_->stops(), 0U);
}

TEST_F(RobotOverSoil, ReportsTheMeanOfWhatItMetSinceTheReportBefore) {
  run(4, digging);
  (void)robot_->report();
  const double from = robot_->index();
  Wrench sum;
  for (int tick = 0; tick < 40; ++tick) {
    run(kTick_s, digging);
    sum.add(robot_->met());
  }
  const RobotReport report = robot_->report();
  EXPECT_EQ(report.index, static_cast<std::uint64_t>(robot_->index()));
  EXPECT_EQ(report.ticks, static_cast<std::uint32_t>(report.index - static_cast<std::uint64_t>(from)));
  EXPECT_LT((report.met.force_n - sum.force_n / 40).norm(), 1e-12);
  EXPECT_EQ(report.pose.position_m, robot_->tool().pose.position_m);
}

TEST_F(RobotOverSoil, StandsStillInSilenceThenLiftsTheToolOutAndComesBack) {
  run(5, digging);
  ASSERT_EQ(robot_->state(), RobotState::kFollowing);
  run(1, digging, false);
  EXPECT_EQ(robot_->state(), RobotState::kFollowing) << "it has not given up yet";
  expectAtRest();
  EXPECT_LT(robot_->tool().pose.position_m.z(), 0);
  run(2.5, digging, false);
  EXPECT_EQ(robot_->reason(), StopReason::kSilence);
  run(5, digging, false);
  EXPECT_EQ(robot_->state(), RobotState::kWaiting);
  EXPECT_GT(robot_->tool().pose.position_m.z(), 0.07) << "above the soil";
  expectAtRest();
  const auto away = [](std::uint64_t index) { return at(index, {0.01, 0.01, 0.09}); };
  run(6, away);
  EXPECT_EQ(robot_->state(), RobotState::kFollowing) << "the connection goes on";
  EXPECT_LT((robot_->tool().pose.position_m - Vec3(0.01, 0.01, 0.09)).norm(), 1e-3);
}

TEST_F(RobotOverSoil, AGapThatNoHandCanBeGuessedOverStopsIt) {
  run(5, digging);
  run(0.3, digging, false);
  run(1, digging);
  EXPECT_EQ(robot_->stops(), 0U) << "a third of a second is bridged";
  run(1.5, digging, false);
  run(0.5, digging);
  EXPECT_EQ(robot_->reason(), StopReason::kGap);
  EXPECT_EQ(robot_->state(), RobotState::kHolding);
  const auto still = [](std::uint64_t index) { return at(index, {0.01, 0, -0.01}); };
  run(8, still);
  EXPECT_EQ(robot_->state(), RobotState::kFollowing) << "up, across and down again";
  EXPECT_LT((robot_->tool().pose.position_m - Vec3(0.01, 0, -0.01)).norm(), 3e-3);
}

TEST_F(RobotOverSoil, AnImpossibleJumpStopsItBeforeItMoves) {
  run(3.5, digging);
  const Vec3 before = robot_->tool().pose.position_m;
  const auto jumped = [](std::uint64_t index) { return at(index, {0.2, 0, 0.1}); };
  run(0.5, jumped);
  EXPECT_EQ(robot_->reason(), StopReason::kJump);
  EXPECT_LT((robot_->tool().pose.position_m - before).norm(), 0.02) << "not towards it";
  double fastest_m_s = 0;
  for (int i = 0; i < 80; ++i) {
    run(0.1, jumped);
    fastest_m_s = std::max(fastest_m_s, robot_->tool().twist.linear_m_s.norm());
  }
  EXPECT_EQ(robot_->state(), RobotState::kFollowing) << "it gets there in its own time";
  EXPECT_LT(fastest_m_s, 0.2);
  EXPECT_LT((robot_->tool().pose.position_m - Vec3(0.2, 0, 0.1)).norm(), 1e-3);
}

TEST_F(RobotOverSoil, AHandThatLetsGoStopsIt) {
  run(5, digging);
  run(0.2, digging, true, false);
  EXPECT_EQ(robot_->reason(), StopReason::kReleased);
  EXPECT_EQ(robot_->state(), RobotState::kHolding);
  run(4, digging, true, false);
  EXPECT_EQ(robot_->state(), RobotState::kWaiting);
  EXPECT_GT(robot_->tool().pose.position_m.z(), 0.07);
}

TEST_F(RobotOverSoil, AnOperatorWhoBeginsAnewInMidStrokeStopsItAndIsFollowedThen) {
  run(5, digging);
  connection_ = 2;
  begun_ = now_;  // its ticks begin at 0 again
  const auto still = [](std::uint64_t index) { return at(index, {0, 0, 0.09}); };
  run(0.2, still);
  EXPECT_EQ(robot_->reason(), StopReason::kRestart);
  expectAtRest();
  run(5, still);
  EXPECT_EQ(robot_->state(), RobotState::kFollowing);
  EXPECT_EQ(robot_->connection(), 2U);
}

TEST_F(RobotOverSoil, ARobotThatBeginsAnewInMidStrokeGoesAboveTheSoilToWhereTheHandIs) {
  run(5, digging);
  begin({});
  double furthest_down_aside_m = 1;
  for (int i = 0; i < 500; ++i) {
    run(0.01, digging);
    const Vec3& tool = robot_->tool().pose.position_m;
    if (robot_->state() == RobotState::kApproaching &&
        std::hypot(tool.x() - digging(now_ - 1).hand.pose.position_m.x(), tool.y()) > 0.03) {
      furthest_down_aside_m = std::min(furthest_down_aside_m, tool.z());
    }
  }
  EXPECT_GT(furthest_down_aside_m, 0.05);
}

TEST_F(RobotOverSoil, BeginsWithWhatIsNewNotWithWhatIsSentAgain) {
  std::vector<Keyframe> keyframes;
  for (std::uint64_t index = 4000; index <= 6400; index += 300) {
    keyframes.push_back(at(index, {0, 0, 0.09}));
  }
  robot_->take(1, true, keyframes);
  robot_->tick();
  EXPECT_GT(robot_->index(), 6300);
}

TEST_F(RobotOverSoil, PullsNoHarderThanItsCapAndStaysBehind) {
  RobotParameters weak;
  weak.max_force_n = 0.3;
  begin(weak);
  double strongest_n = 0;
  bool at_cap = false;
  const auto down = [](std::uint64_t index) {
    const double t = static_cast<double>(index) * kTick_s;
    const double z = 0.085 - 0.04 * std::clamp(t - 1, 0.0, 3.0);
    return at(index, {0, 0, z}, {0, 0, t > 1 && t < 4 ? -0.04 : 0});
  };
  for (int i = 0; i < 600; ++i) {
    run(0.01, down);
    at_cap = at_cap || robot_->atForceCap();
    strongest_n = std::max(strongest_n, scene_->soilWrench().force_n.norm());
  }
  EXPECT_TRUE(at_cap);
  EXPECT_GT(robot_->tool().pose.position_m.z(), -0.03) << "the soil holds it";
}

TEST_F(RobotOverSoil, TooMuchForceStopsIt) {
  RobotParameters careful;
  careful.stop_force_n = 0.2;
  begin(careful);
  run(6, digging);
  EXPECT_GT(robot_->stops(), 0U);
  EXPECT_EQ(robot_->reason(), StopReason::kForce);
}

TEST_F(RobotOverSoil, FollowsToTheEdgeOfItsWorkspaceAndNoFurther) {
  RobotParameters small;
  small.highest_m = {0.02, 0.5, 0.5};
  begin(small);
  const auto out = [](std::uint64_t index) {
    const double x = std::min(0.05, 0.02 * static_cast<double>(index) * kTick_s);
    return at(index, {x, 0, 0.09}, {x < 0.05 ? 0.02 : 0, 0, 0});
  };
  run(5, out);
  EXPECT_TRUE(robot_->atWorkspaceEdge());
  EXPECT_LT(robot_->tool().pose.position_m.x(), 0.0205);
}

TEST_F(RobotOverSoil, CommandsFasterThanItMayMoveAreFollowedLate) {
  RobotParameters slow;
  slow.max_speed_m_s = 0.05;
  begin(slow);
  run(1, [](std::uint64_t index) { return at(index, {0, 0, 0.085}); });
  const auto quick = [](std::uint64_t index) {
    const double t = std::clamp(static_cast<double>(index) * kTick_s - 1, 0.0, 0.3);
    return at(index, {0.3 * t, 0, 0.085}, {t > 0 && t < 0.3 ? 0.3 : 0, 0, 0});
  };
  double fastest_m_s = 0;
  for (int i = 0; i < 40; ++i) {
    run(0.1, quick);
    fastest_m_s = std::max(fastest_m_s, robot_->tool().twist.linear_m_s.norm());
  }
  EXPECT_LT(fastest_m_s, 0.075);
  EXPECT_NEAR(robot_->tool().pose.position_m.x(), 0.09, 1e-3);
}

TEST_F(RobotOverSoil, WhatIsNoNumberEndsIt) {
  run(2, digging);
  robot_->take(connection_, true, std::vector{at(now_ + 20, {std::numeric_limits<double>::quiet_NaN(), 0, 0})});
  run(1, digging);
  EXPECT_EQ(robot_->state(), RobotState::kFailed);
  EXPECT_EQ(robot_->reason(), StopReason::kFault);
  const Vec3 there = scene_->toolPose().position_m;
  run(1, digging);
  EXPECT_TRUE(there.allFinite()) << "the bed has not learnt of it";
  EXPECT_EQ(scene_->toolPose().position_m, there) << "it moves no more";
}

TEST(RobotParameters, RefuseNonsense) {
  RobotParameters robot;
  EXPECT_NO_THROW(validate(robot, kTick_s));
  robot.max_force_n = 0;
  EXPECT_THROW(validate(robot, kTick_s), InvalidParameter);
  robot = {};
  robot.arm.mass_kg = 0.01;
  EXPECT_THROW(validate(robot, kTick_s), InvalidParameter);
  robot = {};
  robot.highest_m.x() = -1;
  EXPECT_THROW(validate(robot, kTick_s), InvalidParameter);
  robot = {};
  robot.sensor.lag_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(validate(robot, kTick_s), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
