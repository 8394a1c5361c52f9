// Tools that a joint turns: wheels and drills.

#include "haptolith/tool/joint.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/core/turn.h"
#include "haptolith/scene/scene.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;
constexpr double kInertia_kg_m2 = 1e-3;

/// A smooth wheel: a cylinder whose axle, z of the tool, lies along y of the scene.
ToolParameters wheel(const Joint& joint) {
  return {.shape = ToolShape::kCylinder, .diameter_m = 0.06, .length_m = 0.04, .joint = joint};
}

Quat axleAlongY() {
  return turnAbout(Vec3::UnitX(), -std::numbers::pi / 2);
}

HandState hubAt(const Vec3& position_m, const Vec3& velocity_m_s = Vec3::Zero()) {
  return {{{position_m, axleAlongY()}, {velocity_m_s, Vec3::Zero()}}, 1};
}

class JointInSoil : public testing::TestWithParam<FrictionModel> {
 protected:
  [[nodiscard]] static BedParameters bed() {
    BedParameters bed;
    bed.soil.friction = GetParam();
    bed.soil.stiffness_n_m = GetParam() == FrictionModel::kContact ? 1000 : bed.soil.stiffness_n_m;
    bed.width_m = 0.2;
    bed.length_m = 0.1;
    bed.depth_m = 0.05;
    bed.start = BedStart::kPacked;
    return bed;
  }

  /// The hub 15 mm of wheel deep in the soil, going along x.
  [[nodiscard]] static HandState driving(double surface_m, double speed_m_s, int tick) {
    const double x_m = speed_m_s * kTick_s * tick - 0.03;
    return hubAt({x_m, 0, surface_m + 0.015}, {speed_m_s, 0, 0});
  }
};
INSTANTIATE_TEST_SUITE_P(EitherFriction, JointInSoil,
                         testing::Values(FrictionModel::kIcra2021, FrictionModel::kContact), [](const auto& param) {
                           return param.param == FrictionModel::kIcra2021 ? "Icra2021" : "Contact";
                         });

TEST(Joint, FreeWheelInEmptySpaceKeepsItsSpeed) {
  Scene scene(BedParameters{}, wheel({.drive = Drive::kFree, .speed_rad_s = 20, .inertia_kg_m2 = kInertia_kg_m2}));
  scene.placeTool(hubAt({0, 0, 0.5}));
  double turned_rad = 0;
  for (int tick = 0; tick < 10'000; ++tick) {
    const double before_rad = scene.joint().angle_rad;
    ASSERT_EQ(scene.tick(hubAt({0, 0, 0.5})), StepStatus::kOk);
    turned_rad += std::remainder(scene.joint().angle_rad - before_rad, 2 * std::numbers::pi);
    ASSERT_LE(std::abs(scene.joint().angle_rad), std::numbers::pi);
  }
  EXPECT_EQ(scene.joint().speed_rad_s, 20);
  EXPECT_NEAR(turned_rad, 200, 200e-9);
  EXPECT_EQ(scene.joint().soil_torque_nm, 0);
  EXPECT_EQ(scene.joint().motor_torque_nm, 0);
}

TEST(Joint, ATorqueSpinsAWheelUp) {
  constexpr double kTorque_nm = 0.01;
  Scene scene(BedParameters{},
              wheel({.drive = Drive::kTorque, .torque_nm = kTorque_nm, .inertia_kg_m2 = kInertia_kg_m2}));
  scene.placeTool(hubAt({0, 0, 0.5}));
  for (int tick = 0; tick < 500; ++tick) {
    ASSERT_EQ(scene.tick(hubAt({0, 0, 0.5})), StepStatus::kOk);
  }
  EXPECT_NEAR(scene.joint().speed_rad_s, kTorque_nm / kInertia_kg_m2 * 0.5, 1e-9);
  EXPECT_EQ(scene.joint().motor_torque_nm, kTorque_nm);
  for (int tick = 0; tick < 20'000; ++tick) {
    ASSERT_EQ(scene.tick(hubAt({0, 0, 0.5})), StepStatus::kOk);
  }
  EXPECT_EQ(scene.joint().speed_rad_s, JointRanges::speed_rad_s.highest) << "but no faster than a step bears";
}

TEST_P(JointInSoil, TheMotorsTorqueIsTheSoilsAndTheInertias) {
  constexpr double kTorque_nm = 0.02;
  const BedParameters soil = bed();
  Scene scene(soil, wheel({.drive = Drive::kTorque, .torque_nm = kTorque_nm, .inertia_kg_m2 = kInertia_kg_m2}));
  const double surface_m = scene.bed().surfaceHeight();
  scene.placeTool(driving(surface_m, 0.1, 0));
  double largest_nm = 0;
  for (int tick = 1; tick <= 500; ++tick) {
    const double before_rad_s = scene.joint().speed_rad_s;
    ASSERT_EQ(scene.tick(driving(surface_m, 0.1, tick)), StepStatus::kOk);
    const JointState& joint = scene.joint();
    const double inertial_nm = kInertia_kg_m2 * (joint.speed_rad_s - before_rad_s) / kTick_s;
    ASSERT_NEAR(joint.motor_torque_nm + joint.soil_torque_nm, inertial_nm, 1e-6 * kTorque_nm) << tick;
    ASSERT_EQ(joint.motor_torque_nm, kTorque_nm);
    largest_nm = std::max(largest_nm, std::abs(joint.soil_torque_nm));
  }
  if (GetParam() == FrictionModel::kContact) {
    EXPECT_GT(largest_nm, 0.2 * kTorque_nm) << "the soil resists";
  } else {
    EXPECT_LT(largest_nm, 1e-12) << "a round tool without friction (paper 21) turns freely";
  }
}

TEST_P(JointInSoil, ATurningToolFeelsWhatAHandFeelsThatTurnsIt) {
  constexpr double kSpeed_rad_s = 5;
  const BedParameters soil = bed();
  const ToolParameters held = wheel({.drive = Drive::kSpeed, .speed_rad_s = kSpeed_rad_s});
  ToolParameters alone = held;
  alone.joint = {};
  Scene by_joint(soil, held);
  Scene by_hand(soil, alone);
  const double surface_m = by_joint.bed().surfaceHeight();
  const auto turnedBy = [&](int tick) {
    HandState hand = hubAt({-0.02 + 1e-4 * tick, 0, surface_m + 0.02}, {0.1, 0, 0});
    hand.pose.orientation = hand.pose.orientation * turnAbout(Vec3::UnitZ(), kSpeed_rad_s * kTick_s * tick);
    hand.twist.angular_rad_s = axleAlongY() * (kSpeed_rad_s * Vec3::UnitZ());
    return hand;
  };
  const auto hub = [&](int tick) { return hubAt({-0.02 + 1e-4 * tick, 0, surface_m + 0.02}, {0.1, 0, 0}); };
  by_joint.placeTool(hub(0));
  by_hand.placeTool(turnedBy(0));
  double felt_n = 0;
  for (int tick = 1; tick <= 30; ++tick) {
    ASSERT_EQ(by_joint.tick(hub(tick)), StepStatus::kOk);
    ASSERT_EQ(by_hand.tick(turnedBy(tick)), StepStatus::kOk);
    const Wrench& wrench = by_joint.soilWrench();
    const Wrench& expected = by_hand.soilWrench();
    felt_n = std::max(felt_n, expected.force_n.norm());
    ASSERT_LE((wrench.force_n - expected.force_n).norm(), 1e-6 * felt_n)
        << tick;  // float rounding of two paths to a pose
    ASSERT_LE((wrench.torque_nm - expected.torque_nm).norm(), 1e-6 * felt_n) << tick;
    const double about_axis_nm = (axleAlongY() * Vec3::UnitZ()).dot(wrench.torque_nm);
    ASSERT_NEAR(by_joint.joint().soil_torque_nm, about_axis_nm, 1e-12 + 1e-9 * felt_n);
    ASSERT_EQ(by_joint.joint().motor_torque_nm, -by_joint.joint().soil_torque_nm);
    ASSERT_TRUE(by_joint.turnedToolPose().orientation.isApprox(turnedBy(tick).pose.orientation, 1e-12));
  }
  EXPECT_GT(felt_n, 0.01);
}

TEST(Joint, TheSoilsWorkIsThatOfHubAndJoint) {
  // About an axis that does not pass through the tool's origin.
  const Joint joint{.point_m = {0.02, 0.01, 0}, .drive = Drive::kSpeed, .speed_rad_s = 8};
  const Pose hub{Vec3(0.1, -0.2, 0.3), turnAboutXyz(Vec3(0.3, -0.4, 0.5))};
  const Twist hub_twist{Vec3(0.1, 0.2, -0.1), Vec3(0.5, -1, 0.7)};
  const Pose tool = turned(hub, joint, 1.2);
  const Twist twist = turning(hub, hub_twist, joint, joint.speed_rad_s, tool);
  const Wrench on_tool{Vec3(1, -2, 3), Vec3(0.1, 0.2, -0.3)};
  const double axial_nm = torqueAboutAxis(hub, joint, tool, on_tool);
  const Wrench on_hub{on_tool.force_n, on_tool.torque_nm + (tool.position_m - hub.position_m).cross(on_tool.force_n)};
  const auto power = [](const Wrench& wrench, const Twist& moving) {
    return wrench.force_n.dot(moving.linear_m_s) + wrench.torque_nm.dot(moving.angular_rad_s);
  };
  EXPECT_NEAR(power(on_tool, twist), power(on_hub, hub_twist) + axial_nm * joint.speed_rad_s, 1e-12);
  // The twist is what the pose does.
  constexpr double kStep_s = 1e-7;
  const Pose later = turned(
      {hub.position_m + kStep_s * hub_twist.linear_m_s,
       turnAbout(hub_twist.angular_rad_s.normalized(), kStep_s * hub_twist.angular_rad_s.norm()) * hub.orientation},
      joint, 1.2 + kStep_s * joint.speed_rad_s);
  EXPECT_LT(((later.position_m - tool.position_m) / kStep_s - twist.linear_m_s).norm(), 1e-5);
  EXPECT_LT((rotationVector(later.orientation * tool.orientation.conjugate()) / kStep_s - twist.angular_rad_s).norm(),
            1e-5);
}

TEST_P(JointInSoil, ASpinningWheelPullsAndALockedOneDrags) {
  const BedParameters soil = bed();
  const auto pullAt = [&](double rim_m_s) {
    Scene scene(soil, wheel({.drive = Drive::kSpeed, .speed_rad_s = rim_m_s / 0.03}));
    const double surface_m = scene.bed().surfaceHeight();
    scene.placeTool(driving(surface_m, 0.05, 0));
    double sum_n = 0;
    for (int tick = 1; tick <= 800; ++tick) {
      EXPECT_EQ(scene.tick(driving(surface_m, 0.05, tick)), StepStatus::kOk);
      sum_n += tick > 300 ? scene.soilWrench().force_n.x() : 0;
    }
    return sum_n / 500;
  };
  const double locked_n = pullAt(0), spinning_n = pullAt(0.5);
  EXPECT_LT(locked_n, 0);
  if (GetParam() == FrictionModel::kContact) {
    EXPECT_GT(spinning_n, locked_n + 0.1 * std::abs(locked_n)) << "the rim pushes soil back";
  }
}

TEST_P(JointInSoil, GoesOnFromASavedSceneBitForBit) {
  const BedParameters soil = bed();
  const ToolParameters tool =
      wheel({.drive = Drive::kTorque, .speed_rad_s = 3, .torque_nm = 0.01, .inertia_kg_m2 = kInertia_kg_m2});
  Scene scene(soil, tool);
  const double surface_m = scene.bed().surfaceHeight();
  scene.placeTool(driving(surface_m, 0.1, 0));
  for (int tick = 1; tick <= 200; ++tick) {
    ASSERT_EQ(scene.tick(driving(surface_m, 0.1, tick)), StepStatus::kOk);
  }
  Scene again(soil, tool, deserialiseSavedScene(serialise(scene.save())));
  for (int tick = 201; tick <= 300; ++tick) {
    ASSERT_EQ(scene.tick(driving(surface_m, 0.1, tick)), StepStatus::kOk);
    ASSERT_EQ(again.tick(driving(surface_m, 0.1, tick)), StepStatus::kOk);
    ASSERT_EQ(again.hash(), scene.hash()) << tick;
    ASSERT_EQ(again.joint().angle_rad, scene.joint().angle_rad);
    ASSERT_EQ(again.joint().soil_torque_nm, scene.joint().soil_torque_nm);
  }
  EXPECT_NE(scene.joint().speed_rad_s, 3);
}

TEST(Joint, DrivesAreSetWithinTheirRange) {
  Scene scene(BedParameters{}, ToolSet({wheel({.drive = Drive::kSpeed, .speed_rad_s = 1}),
                                        wheel({.drive = Drive::kFree, .inertia_kg_m2 = 1}), ToolParameters{}}));
  const std::array hands{hubAt({0, 0, 0.5}), hubAt({0, 0, 0.5}), hubAt({0, 0, 0.5})};
  const auto speedAfter = [&](double value) {
    for (std::size_t i = 0; i < 3; ++i) {
      scene.setDrive(value, i);
    }
    EXPECT_EQ(scene.tickAll(hands), StepStatus::kOk);
    return scene.joint(0).speed_rad_s;
  };
  EXPECT_EQ(speedAfter(2), 2);
  EXPECT_EQ(speedAfter(std::numeric_limits<double>::quiet_NaN()), 2);
  EXPECT_EQ(speedAfter(1e9), JointRanges::speed_rad_s.highest);
  EXPECT_EQ(scene.joint(1).speed_rad_s, 0);
  EXPECT_FALSE(scene.tool(2).joint.any());
}

TEST(Joint, NonsenseIsRefusedByName) {
  const auto expectRefused = [](const std::string& key, const Joint& joint) {
    try {
      const Scene scene(BedParameters{}, wheel(joint));
      ADD_FAILURE() << "a wrong " << key << " passed";
    } catch (const InvalidParameter& error) {
      EXPECT_EQ(error.key(), key);
      EXPECT_THAT(error.what(), testing::HasSubstr("must be"));
    }
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  expectRefused("joint_axis", {.axis = Vec3::Zero()});
  expectRefused("joint_axis", {.axis = {0, 0, kNaN}});
  expectRefused("joint_point_m", {.point_m = {0, 2, 0}});
  expectRefused("joint_speed_rad_s", {.speed_rad_s = 1e9});
  expectRefused("joint_torque_nm", {.drive = Drive::kTorque, .torque_nm = kNaN, .inertia_kg_m2 = 1});
  expectRefused("joint_inertia_kg_m2", {.drive = Drive::kFree});
  expectRefused("joint_inertia_kg_m2", {.drive = Drive::kTorque, .inertia_kg_m2 = 1e-9});  // the step would not bear it
}

TEST(SavedScene, RefusesAJointThatIsNowhere) {
  Scene scene(BedParameters{}, wheel({.drive = Drive::kSpeed, .speed_rad_s = 1}));
  const auto expectRefused = [&](const std::function<void(JointState&)>& spoil) {
    SavedScene saved = scene.save();
    spoil(saved.tools[0].joint);
    EXPECT_THROW(scene.restore(saved), InvalidParameter);
  };
  expectRefused([](JointState& joint) { joint.angle_rad = 4; });
  expectRefused([](JointState& joint) { joint.speed_rad_s = 1e9; });
  expectRefused([](JointState& joint) { joint.soil_torque_nm = std::numeric_limits<double>::infinity(); });
}

}  // namespace
}  // namespace haptolith
