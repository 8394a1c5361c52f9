#include "haptolith/device/hand/hand_motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace haptolith {
namespace {

constexpr HandMotion kAll[] = {HandMotion::kStill, HandMotion::kPress, HandMotion::kStir, HandMotion::kScoop,
                               HandMotion::kCarry, HandMotion::kShake, HandMotion::kCut,  HandMotion::kFurrows};
constexpr double kTick_s = 1e-3;

HandParameters handFor(HandMotion motion) {
  HandParameters hand;
  hand.motion = motion;
  hand.surface_m = 0.035;
  hand.home_m = {0.01, -0.02, 0.085};
  hand.period_s = motion == HandMotion::kFurrows ? 8 : 4;  // five cuts take their time
  return hand;
}

double angleBetween(const Quat& a, const Quat& b) {
  return a.angularDistance(b);
}

TEST(HandMotion, BeginsAndEndsAtHome) {
  for (const HandMotion motion : kAll) {
    const HandParameters hand = handFor(motion);
    const Vec3 home(0.01, -0.02, 0.035 + 0.085);
    const Quat start = handMotionPose(hand, 0).orientation;
    for (const double t : {0.0, hand.period_s, 8.0, hand.period_s - 1e-9}) {
      EXPECT_LT((handMotionPose(hand, t).position_m - home).norm(), 1e-9) << static_cast<int>(motion) << " at " << t;
      EXPECT_LT(angleBetween(handMotionPose(hand, t).orientation, start), 1e-7) << static_cast<int>(motion);
    }
  }
}

TEST(HandMotion, RepeatsEveryPeriod) {
  for (const HandMotion motion : kAll) {
    const HandParameters hand = handFor(motion);
    for (double t = 0.05; t < 4; t += 0.1) {
      // The shake's 5 Hz fit twenty times into four seconds.
      EXPECT_LT((handMotionPose(hand, t).position_m - handMotionPose(hand, t + 8).position_m).norm(), 1e-9);
    }
  }
}

TEST(HandMotion, MovesWithoutJumpsOfPositionOrVelocity) {
  // A minimum-jerk movement over a distance D in time T reaches 1.875 D / T and 5.774 D / T^2. The quickest part of a
  // table takes 4 % of 4 s, the longest distance is that from home to the depth or twice the reach: 0.1 m. Two parts
  // meet at rest. Turning about the axis bends the way: v^2 / r adds to it. The shake has 6 mm (2 pi 5 Hz)^2 = 5.9
  // m/s^2.
  const double shortest_s = 0.04 * 4;
  for (const HandMotion motion : kAll) {
    const HandParameters hand = handFor(motion);
    const double largest_speed = 1.875 * 0.1 / shortest_s + 0.2;
    const double largest_acceleration = 5.774 * 0.1 / (shortest_s * shortest_s) + 6;
    Vec3 x = handMotionPose(hand, 0).position_m;
    Vec3 v = Vec3::Zero();
    for (int tick = 1; tick <= 8000; ++tick) {
      const Vec3 next = handMotionPose(hand, tick * kTick_s).position_m;
      const Vec3 next_v = (next - x) / kTick_s;
      ASSERT_LT(next_v.norm(), largest_speed) << static_cast<int>(motion) << " at " << tick;
      ASSERT_LT((next_v - v).norm() / kTick_s, largest_acceleration) << static_cast<int>(motion) << " at " << tick;
      x = next;
      v = next_v;
    }
  }
}

TEST(HandMotion, GoesThroughTheSurfaceAtOneSpeed) {
  // Press goes from above the surface (0.2 of the home height: 17 mm) to the depth (20 mm) in a quarter of the period:
  // one minimum-jerk movement of 37 mm in 1 s. A jump of velocity would show as an acceleration far above 5.774 D /
  // T^2.
  const HandParameters hand = handFor(HandMotion::kPress);
  const double largest = 5.774 * 0.037;
  double fastest = 0;
  for (int tick = 801; tick < 1799; ++tick) {
    const auto z = [&](int k) { return handMotionPose(hand, k * kTick_s).position_m.z(); };
    ASSERT_LT(std::abs(z(tick + 1) - 2 * z(tick) + z(tick - 1)) / (kTick_s * kTick_s), largest * 1.01) << tick;
    fastest = std::max(fastest, std::abs(z(tick + 1) - z(tick)) / kTick_s);
  }
  EXPECT_NEAR(fastest, 1.875 * 0.037, 1e-4);
}

TEST(HandMotion, TurnsWithoutJumps) {
  // Nothing turns by more than 112 degrees in 10 % of the period, 1.875 * 1.95 rad / 0.32 s, or two rounds in 65 %.
  for (const HandMotion motion : kAll) {
    const HandParameters hand = handFor(motion);
    for (int tick = 1; tick <= 8000; ++tick) {
      const double turned = angleBetween(handMotionPose(hand, tick * kTick_s).orientation,
                                         handMotionPose(hand, (tick - 1) * kTick_s).orientation);
      ASSERT_LT(turned / kTick_s, 20) << static_cast<int>(motion) << " at " << tick;
    }
  }
}

TEST(HandMotion, ReachesItsDepthAndNoDeeper) {
  for (const HandMotion motion : kAll) {
    const HandParameters hand = handFor(motion);
    double lowest = 1;
    for (int tick = 0; tick <= 4000; ++tick) {
      lowest = std::min(lowest, handMotionPose(hand, tick * kTick_s).position_m.z());
    }
    EXPECT_GE(lowest, 0.035 - 0.020 - 1e-12) << static_cast<int>(motion);
    if (motion == HandMotion::kPress) {
      EXPECT_NEAR(lowest, 0.015, 1e-9);
    }
  }
}

TEST(HandMotion, EndsWhatItBeganAndThenWaitsAtHome) {
  HandParameters hand = handFor(HandMotion::kScoop);
  hand.active_s = 5;  // in the second of two
  const HandParameters forever = handFor(HandMotion::kScoop);
  for (double t = 4.1; t < 8; t += 0.1) {
    EXPECT_EQ(handMotionPose(hand, t).position_m, handMotionPose(forever, t).position_m) << t;
  }
  for (double t = 8; t < 60; t += 0.37) {
    EXPECT_EQ(handMotionPose(hand, t).position_m, handMotionPose(hand, 0).position_m) << t;
  }
  hand.active_s = 0;
  EXPECT_EQ(handMotionPose(hand, 1).position_m, handMotionPose(hand, 0).position_m);
}

TEST(HandMotion, StillIsStill) {
  const HandParameters hand = handFor(HandMotion::kStill);
  for (double t = 0; t < 10; t += 0.1) {
    EXPECT_EQ(handMotionPose(hand, t).position_m, handMotionPose(hand, 0).position_m);
  }
}

TEST(HandMotionOpening, ClosesAtTheLowestPointAndOpensWhereTheSoilIsTippedOut) {
  const HandParameters hand = handFor(HandMotion::kScoop);
  double lowest_m = 1;
  double lowest_s = 0;
  double before = 1;
  for (double t = 0; t < 4; t += kTick_s) {
    const double open = handMotionOpening(hand, t);
    EXPECT_GE(open, 0);
    EXPECT_LE(open, 1);
    EXPECT_LT(std::abs(open - before), 0.01) << "no jumps";
    before = open;
    if (const double z_m = handMotionPose(hand, t).position_m.z(); z_m < lowest_m) {
      lowest_m = z_m;
      lowest_s = t;
    }
  }
  EXPECT_EQ(handMotionOpening(hand, 0), 1);
  EXPECT_EQ(handMotionOpening(hand, lowest_s - 0.4), 1) << "open on the way down";
  EXPECT_LT(handMotionOpening(hand, lowest_s), 0.2);
  EXPECT_EQ(handMotionOpening(hand, lowest_s + 0.1), 0) << "closed on the way up";
  EXPECT_EQ(handMotionOpening(hand, 4 - kTick_s), 1);
}

TEST(HandMotion, CutsStraightAtOneDepthWithItsEdgeAhead) {
  const HandParameters hand = handFor(HandMotion::kCut);
  const double from_s = 0.11 * hand.period_s;
  const double to_s = 0.25 * hand.period_s;
  const Vec3 begin = handMotionPose(hand, from_s).position_m;
  for (double t = from_s; t <= to_s; t += 0.01) {
    const Pose pose = handMotionPose(hand, t);
    EXPECT_NEAR(pose.position_m.z(), 0.035 - hand.depth_m, 1e-12);
    EXPECT_NEAR(pose.position_m.y(), begin.y(), 1e-12);
    const Vec3 edge = pose.orientation * Vec3(0.025, 0, 0);  // the shovel's end that is in the soil
    EXPECT_GT(edge.x(), 0) << "ahead of its middle";
    EXPECT_LT(edge.z(), -0.02);
  }
  EXPECT_NEAR(handMotionPose(hand, to_s).position_m.x() - begin.x(), 2 * hand.reach_m, 1e-12);
}

TEST(HandMotion, CutsFurrowsBesideEachOtherEachOnce) {
  const HandParameters hand = handFor(HandMotion::kFurrows);
  std::vector<double> furrows_m;
  double furthest_m = 0;
  for (double t = 0; t < hand.period_s; t += 1e-3) {
    const Pose pose = handMotionPose(hand, t);
    if (pose.position_m.z() < 0.035 - hand.depth_m + 1e-9) {  // at its depth
      if (furrows_m.empty() || std::abs(furrows_m.back() - pose.position_m.y()) > 1e-9) {
        furrows_m.push_back(pose.position_m.y());
        EXPECT_NEAR(pose.position_m.x(), hand.home_m.x() - hand.reach_m, 1e-3) << "begins at the same end";
      }
      furthest_m = std::max(furthest_m, pose.position_m.x());
    }
  }
  ASSERT_EQ(furrows_m.size(), 5U);
  for (std::size_t i = 1; i < furrows_m.size(); ++i) {
    EXPECT_NEAR(furrows_m[i] - furrows_m[i - 1], 0.7 * hand.reach_m, 1e-9);
  }
  EXPECT_NEAR(furthest_m, hand.home_m.x() + hand.reach_m / 2, 1e-6);
}

TEST(HandMotionOpening, IsOpenInAnythingThatLiftsNothingAndAtTheEnd) {
  for (const HandMotion motion :
       {HandMotion::kStill, HandMotion::kPress, HandMotion::kStir, HandMotion::kCut, HandMotion::kFurrows}) {
    for (double t = 0; t < 8; t += 0.01) {
      EXPECT_EQ(handMotionOpening(handFor(motion), t), 1);
    }
  }
  HandParameters hand = handFor(HandMotion::kCarry);
  EXPECT_EQ(handMotionOpening(hand, 4 * 0.5), 0);
  hand.active_s = 4;
  EXPECT_EQ(handMotionOpening(hand, 4 * 1.5), 1) << "over";
}

}  // namespace
}  // namespace haptolith
