#include "haptolith/device/hand/virtual_hand.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/device/hand/hand_motion.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;

HandParameters still() {
  HandParameters hand;
  hand.motion = HandMotion::kStill;
  return hand;
}

TEST(VirtualHand, YieldsByForceOverStiffness) {
  VirtualHand hand(still(), kTick_s);
  const Vec3 home = hand.read().pose.position_m;
  hand.write({{Vec3(1.35, -2.7, 0.675), Vec3::Zero()}});
  DeviceInput now;
  for (int i = 0; i < 10'000; ++i) {
    now = hand.read();
  }
  // F / K with K = 135 N/m: 10, -20 and 5 mm. After 10 s exp(-B/2m t) = exp(-58) is left of the swing.
  EXPECT_LT((now.pose.position_m - home - Vec3(0.010, -0.020, 0.005)).norm(), 1e-12);
  EXPECT_LT(now.twist.linear_m_s.norm(), 1e-12);
}

TEST(VirtualHand, TurnsByTorqueOverItsRotationalStiffness) {
  VirtualHand hand(still(), kTick_s);
  const Quat home = hand.read().pose.orientation;
  const Vec3 axis = Vec3(1, 2, -2) / 3;
  hand.write({{Vec3::Zero(), 0.3 * axis}});
  DeviceInput now;
  for (int i = 0; i < 10'000; ++i) {
    now = hand.read();
  }
  // K l^2 = 135 * 0.01 = 1.35 N m/rad: 0.2222 rad about the torque's axis.
  const Eigen::AngleAxisd turned(now.pose.orientation * home.conjugate());
  EXPECT_NEAR(turned.angle(), 0.3 / 1.35, 1e-9);
  EXPECT_LT((turned.axis() - axis).norm(), 1e-9);
}

/// Height of a damped oscillator of the arm's values t after a constant force began to act, from rest.
double stepResponse(double force_n, double t) {
  constexpr double m = 0.554, b = 6.45, k = 135;
  const double decay = b / (2 * m);
  const double omega = std::sqrt(k / m - decay * decay);
  return force_n / k * (1 - std::exp(-decay * t) * (std::cos(omega * t) + decay / omega * std::sin(omega * t)));
}

TEST(VirtualHand, AnswersAStepLikeADampedOscillator) {
  VirtualHand hand(still(), kTick_s);
  const double home = hand.read().pose.position_m.z();
  hand.write({{Vec3(0, 0, 2.7), Vec3::Zero()}});
  double largest = 0;
  for (int tick = 1; tick <= 2000; ++tick) {
    const double moved = hand.read().pose.position_m.z() - home;
    // One semi-implicit step is late or early by up to half a tick: v dt / 2 < 0.16 m/s * 0.5 ms = 8e-5 m.
    ASSERT_NEAR(moved, stepResponse(2.7, tick * kTick_s), 2e-4) << tick;
    largest = std::max(largest, moved);
  }
  // Damping ratio B / (2 sqrt(K m)) = 0.373: overshoot exp(-pi 0.373 / sqrt(1 - 0.373^2)) = 28.3 %.
  EXPECT_NEAR(largest, 0.02 * 1.283, 2e-4);
}

TEST(VirtualHand, StepResponseConvergesWithTheTick) {
  const auto worst = [](double tick_s) {
    VirtualHand hand(still(), tick_s);
    const double home = hand.read().pose.position_m.z();
    hand.write({{Vec3(0, 0, 2.7), Vec3::Zero()}});
    double error = 0;
    for (int tick = 1; tick * tick_s <= 1; ++tick) {
      error = std::max(error, std::abs(hand.read().pose.position_m.z() - home - stepResponse(2.7, tick * tick_s)));
    }
    return error;
  };
  EXPECT_NEAR(worst(1e-3) / worst(0.5e-3), 2, 0.1);  // first order
}

TEST(VirtualHand, RigidFollowsTheMotionExactlyWhateverItFeels) {
  HandParameters parameters;
  parameters.compliance = HandCompliance::kRigid;
  VirtualHand hand(parameters, kTick_s);
  Pose before = handMotionPose(parameters, 0);
  for (int tick = 1; tick <= 4000; ++tick) {
    const DeviceInput now = hand.read();
    const Pose wanted = handMotionPose(parameters, tick * kTick_s);
    ASSERT_EQ(now.pose.position_m, wanted.position_m);
    ASSERT_EQ(now.pose.orientation.coeffs(), wanted.orientation.coeffs());
    ASSERT_LT((now.twist.linear_m_s - (wanted.position_m - before.position_m) / kTick_s).norm(), 1e-12);
    // The angular velocity turns the last orientation into this one.
    const Vec3 turn = kTick_s * now.twist.angular_rad_s;
    const Quat turned = turn.norm() == 0 ? before.orientation
                                         : Quat(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * before.orientation;
    ASSERT_LT(turned.angularDistance(wanted.orientation), 1e-7) << tick;
    before = wanted;
    hand.write({{Vec3(12, 12, 12), Vec3(1, 1, 1)}});
  }
}

TEST(VirtualHand, AFreeArmFollowsItsMotionClosely) {
  for (const HandMotion motion : {HandMotion::kPress, HandMotion::kStir, HandMotion::kScoop, HandMotion::kCarry}) {
    HandParameters parameters;
    parameters.motion = motion;
    VirtualHand hand(parameters, kTick_s);
    for (int tick = 1; tick <= 8000; ++tick) {
      const DeviceInput now = hand.read();
      const Pose wanted = handMotionPose(parameters, tick * kTick_s);
      // m x_d'' / K with 5.774 * 0.08 m / (0.32 s)^2 = 4.5 m/s^2: 18 mm, and a little for the swing.
      ASSERT_LT((now.pose.position_m - wanted.position_m).norm(), 0.03) << tick;
      ASSERT_NEAR(now.pose.orientation.norm(), 1, 1e-12);
    }
  }
}

TEST(VirtualHand, RefusesAnArmThatOneTickCannotFollow) {
  // The semi-implicit step is stable for K dt^2 / m + 2 B dt / m < 4.
  HandParameters stiff = still();
  stiff.stiffness_n_m = 1e5;
  stiff.mass_kg = 0.01;
  EXPECT_THROW((VirtualHand{stiff, kTick_s}), InvalidParameter);
  HandParameters damped = still();
  damped.damping_n_s_m = 1000;
  damped.mass_kg = 0.1;
  EXPECT_THROW((VirtualHand{damped, kTick_s}), InvalidParameter);
  damped.compliance = HandCompliance::kRigid;  // no arm, no matter
  EXPECT_NO_THROW((VirtualHand{damped, kTick_s}));
}

TEST(VirtualHand, TellsItsLimits) {
  const VirtualHand hand(still(), kTick_s);
  EXPECT_EQ(hand.limits().max_force_n, 12);
  EXPECT_EQ(hand.limits().max_torque_nm, 0.2);
  EXPECT_EQ(hand.name(), "virtual hand");
}

TEST(VirtualHand, RefusesWrongParametersAndMissingFiles) {
  HandParameters hand;
  hand.mass_kg = 0;
  EXPECT_THROW((VirtualHand{hand, kTick_s}), InvalidParameter);
  hand = {};
  hand.motion = HandMotion::kPoses;
  hand.poses_file = "/nowhere/poses.csv";
  EXPECT_THROW((VirtualHand{hand, kTick_s}), InvalidParameter);
}

DeviceInput after(VirtualHand& hand, int ticks) {
  DeviceInput now;
  for (int i = 0; i < ticks; ++i) {
    now = hand.read();
  }
  return now;
}

TEST(VirtualHand, WhoeverHoldsTheToolPullsItToThePoseAndBringsItToRestThere) {
  VirtualHand hand(HandParameters{}, kTick_s);
  (void)after(hand, 100);
  const Pose wanted{Vec3(0.03, -0.02, 0.06), Quat(Eigen::AngleAxisd(0.5, Vec3::UnitY()))};
  hand.command({.held = wanted});
  const DeviceInput soon = after(hand, 60);
  EXPECT_GT((soon.pose.position_m - wanted.position_m).norm(), 1e-3) << "it is pulled, not put there";
  const DeviceInput later = after(hand, 1000);
  EXPECT_LT((later.pose.position_m - wanted.position_m).norm(), 1e-6);
  EXPECT_LT(later.pose.orientation.angularDistance(wanted.orientation), 1e-6);
  EXPECT_LT(later.twist.linear_m_s.norm(), 1e-5);
}

TEST(VirtualHand, WhoeverHoldsTheToolCannotForceItThroughWhatIsStrongerThanTheDevice) {
  HandParameters parameters = still();
  parameters.max_force_n = 5;
  VirtualHand hand(parameters, kTick_s);
  const Vec3 start = hand.read().pose.position_m;
  hand.command({.held = Pose{start - Vec3(0, 0, 1)}});  // 300 N by the coupling's stiffness alone
  hand.write({{Vec3(0, 0, 5.01), Vec3::Zero()}});
  EXPECT_GE(after(hand, 1000).pose.position_m.z(), start.z());
  hand.write({{Vec3(0, 0, 4.9), Vec3::Zero()}});
  EXPECT_LT(after(hand, 1000).pose.position_m.z(), start.z());
}

TEST(VirtualHand, AMotionBeginsAnewFromWhereSomebodyLeftTheTool) {
  HandParameters parameters;
  parameters.surface_m = 0.04;
  VirtualHand hand(parameters, kTick_s);
  hand.command({.held = Pose{Vec3(-0.05, 0.05, 0.03)}, .surface_m = 0.04});
  DeviceInput now = after(hand, 2000);
  hand.command({.motion = HandMotion::kStir, .surface_m = 0.04, .beginnings = 1});
  double fastest = 0;
  for (int i = 0; i < 1000; ++i) {
    now = hand.read();
    fastest = std::max(fastest, now.twist.linear_m_s.norm());
  }
  EXPECT_LT(fastest, 0.35) << "it is led back, not flung";
  // One second later it stirs as a hand that has stirred from the first tick.
  HandParameters stir = parameters;
  stir.motion = HandMotion::kStir;
  now = after(hand, 3000);
  const Pose there = handMotionPose(stir, 3.0);
  EXPECT_LT((now.pose.position_m - there.position_m).norm(), 0.01);
}

}  // namespace
}  // namespace haptolith
