#include "haptolith/teleop/operator/task_hand.h"

#include <gtest/gtest.h>

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;
const Pose kHome{{0, 0, 0.08}, Quat::Identity()};

TEST(TaskHand, GoesWhereItIsWantedAndYieldsAsItsArmDoes) {
  TaskHand stiff(std::nullopt, {}, kTick_s, kHome);
  TaskHand arm(ArmParameters{.mass_kg = 0.5, .damping_n_s_m = 20, .stiffness_n_m = 800}, {}, kTick_s, kHome);
  const Pose there{{0.001, 0, 0.08}, Quat::Identity()};
  stiff.want(there);
  arm.want(there);
  EXPECT_EQ(stiff.read().pose.position_m, there.position_m);
  EXPECT_NEAR(stiff.read().twist.linear_m_s.x(), 0, 1e-12);
  for (int tick = 0; tick < 2000; ++tick) {
    stiff.write({{{0, 0, 4}, Vec3::Zero()}, 0});
    arm.write({{{0, 0, 4}, Vec3::Zero()}, 0});
    (void)stiff.read();
    (void)arm.read();
  }
  EXPECT_EQ(stiff.read().pose.position_m, there.position_m);
  EXPECT_NEAR(arm.read().pose.position_m.z(), 0.08 + 4.0 / 800, 1e-6);
}

TEST(TaskHand, GoesOnAsItWentWhenNobodyHoldsItAndComesToRest) {
  TaskHand hand(std::nullopt, {}, kTick_s, kHome);
  hand.releaseTool({kHome, {{0.1, 0, 0}, Vec3::Zero()}});
  EXPECT_NEAR(hand.read().twist.linear_m_s.x(), 0.1, 0.001);
  DeviceInput input;
  for (int tick = 0; tick < 3000; ++tick) {
    input = hand.read();
  }
  EXPECT_NEAR(input.twist.linear_m_s.x(), 0, 1e-6);
  EXPECT_NEAR(input.pose.position_m.x(), 0.1 * 0.3 / 2, 1e-3) << "v m / B";
}

}  // namespace
}  // namespace haptolith
