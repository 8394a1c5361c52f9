#include "haptolith/teleop/link/command_track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;

Keyframe keyAt(std::uint64_t index, const Vec3& position_m, const Vec3& velocity_m_s = Vec3::Zero()) {
  Keyframe key;
  key.index = index;
  key.hand.pose.position_m = position_m;
  key.hand.twist.linear_m_s = velocity_m_s;
  return key;
}

/// A hand that goes to and fro by 35 mm in 2 s, and turns by 20 degrees meanwhile.
Keyframe swinging(std::uint64_t index) {
  const double w = std::numbers::pi;
  const double t = static_cast<double>(index) * kTick_s;
  Keyframe key = keyAt(index, {0.035 * std::sin(w * t), 0, 0.1}, {0.035 * w * std::cos(w * t), 0, 0});
  key.hand.pose.orientation = Eigen::AngleAxisd(0.35 * std::sin(w * t), Vec3::UnitY());
  key.hand.twist.angular_rad_s = {0, 0.35 * w * std::cos(w * t), 0};
  key.hand.opening = 0.5;
  return key;
}

TEST(CommandTrack, FollowsACubicExactly) {
  const auto place = [](double t) { return Vec3(1 + 2 * t - 3 * t * t + 4 * t * t * t, -t, 0.5 * t * t); };
  const auto speed = [](double t) { return Vec3(2 - 6 * t + 12 * t * t, -1, t); };
  CommandTrack track(kTick_s);
  track.add(keyAt(100, place(0.1), speed(0.1)));
  track.add(keyAt(500, place(0.5), speed(0.5)));
  for (double index = 100; index < 500; index += 7.3) {
    const HandState hand = track.at(index);
    EXPECT_LT((hand.pose.position_m - place(index * kTick_s)).norm(), 1e-12);
    EXPECT_LT((hand.twist.linear_m_s - speed(index * kTick_s)).norm(), 1e-10);
  }
}

TEST(CommandTrack, AHandsMovementComesOutOfFewKeys) {
  for (const std::uint64_t period : {20U, 400U}) {
    // Hermite's cubic is wrong by T^4 / 384 times the fourth derivative at most; floating point comes on top.
    const double share = std::pow(static_cast<double>(period) * kTick_s * std::numbers::pi, 4) / 384;
    CommandTrack track(kTick_s);
    for (std::uint64_t index = 0; index <= 4000; index += period) {
      track.add(swinging(index));
    }
    double furthest_m = 0, furthest_rad = 0;
    for (std::uint64_t index = 0; index < 4000; ++index) {
      const Pose is = track.at(static_cast<double>(index)).pose;
      const Pose was = swinging(index).hand.pose;
      furthest_m = std::max(furthest_m, (is.position_m - was.position_m).norm());
      furthest_rad = std::max(furthest_rad, is.orientation.angularDistance(was.orientation));
      EXPECT_DOUBLE_EQ(track.at(static_cast<double>(index)).opening, 0.5);
    }
    EXPECT_LT(furthest_m, 0.035 * share + 1e-15);
    EXPECT_GT(furthest_m, 0.5 * 0.035 * share);
    EXPECT_LT(furthest_rad, 0.35 * share + 1e-7);
  }
}

TEST(CommandTrack, TakesKeysInAnyOrderAndTwice) {
  CommandTrack track(kTick_s);
  for (const std::uint64_t index : {40U, 0U, 20U, 40U, 0U, 60U, 20U}) {
    track.add(swinging(index));
  }
  EXPECT_EQ(track.oldest(), 40U) << "what is older than the first is not entered before it";
  EXPECT_EQ(track.newest(), 60U);
  const auto [from, to] = track.around(45);
  EXPECT_EQ(from.index, 40U);
  EXPECT_EQ(to.index, 60U);
  CommandTrack late(kTick_s);
  for (const std::uint64_t index : {0U, 60U, 20U, 40U}) {
    late.add(swinging(index));
  }
  EXPECT_EQ(late.around(45).from.index, 40U) << "what was lost and comes later takes its place";
}

TEST(CommandTrack, StandsStillBeforeAndBehind) {
  CommandTrack track(kTick_s);
  track.add(keyAt(10, {1, 0, 0}, {5, 0, 0}));
  track.add(keyAt(20, {2, 0, 0}, {5, 0, 0}));
  EXPECT_EQ(track.at(0).pose.position_m.x(), 1);
  EXPECT_EQ(track.at(99).pose.position_m.x(), 2);
  EXPECT_TRUE(track.at(99).twist.linear_m_s.isZero(0));
}

TEST(CommandTrack, ForgetsWhatIsOverAndKeepsWhereItCameFrom) {
  CommandTrack track(kTick_s);
  for (std::uint64_t index = 0; index <= 100; index += 20) {
    track.add(swinging(index));
  }
  const Vec3 before = track.at(50).pose.position_m;
  track.forgetBefore(50);
  EXPECT_EQ(track.oldest(), 40U);
  EXPECT_EQ(track.at(50).pose.position_m, before);
  track.add(swinging(20));
  EXPECT_EQ(track.oldest(), 40U) << "what has been forgotten does not come back";
}

}  // namespace
}  // namespace haptolith
