// A robot whose topics another vendor's DDS serves, led by commands as they come from an operator.

#include "haptolith/ros2/ros2_arm.h"

#include <gmock/gmock.h>

#include <array>
#include <mutex>
#include <numbers>
#include <thread>

#include "haptolith/teleop/robot/robot.h"

#include "cdr.h"
#include "fast_dds_peer.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;

constexpr double kTick_s = 1e-3;
constexpr const char* kPose = "geometry_msgs::msg::dds_::PoseStamped_";
constexpr const char* kWrench = "geometry_msgs::msg::dds_::WrenchStamped_";

/// A robot that reaches its target immediately, 0.5 m from its base and turned by a quarter, with a sensor that shows
/// a bias of 3 N and `pushes_n` on it, along the base's axes.
class SomeRobot {
 public:
  explicit SomeRobot(int domain) : peer_(domain) {
    peer_.listen("rt/robot/target_pose", kPose, PeerQos::kReliable, [this](const Bytes& bytes) {
      CdrReader reader(bytes);
      (void)reader.get<std::int32_t>();
      (void)reader.get<std::uint32_t>();
      const std::lock_guard lock(mutex_);
      frame_ = reader.text();
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        at_m_[axis] = reader.get<double>();
      }
      ++targets_;
      if (targets_ == 1) {
        first_m_ = at_m_;
      }
    });
    pose_ = peer_.makeWriter("rt/robot/tool_pose", kPose, PeerQos::kBestEffort);
    wrench_ = peer_.makeWriter("rt/robot/wrench", kWrench, PeerQos::kReliable);
  }

  void tell() {
    const std::lock_guard lock(mutex_);
    CdrWriter pose;
    pose.add(std::int32_t{1}).add(std::uint32_t{2}).add("base_link").add(at_m_.x()).add(at_m_.y()).add(at_m_.z());
    pose.add(0.0).add(0.0).add(0.0).add(1.0);
    peer_.write(pose_, pose.bytes());
    CdrWriter wrench;
    wrench.add(std::int32_t{1}).add(std::uint32_t{2}).add("base_link");
    const Vec3 shown_n = pushes_n + Vec3(3, 0, 0);
    wrench.add(shown_n.x()).add(shown_n.y()).add(shown_n.z()).add(0.0).add(0.0).add(0.0);
    peer_.write(wrench_, wrench.bytes());
  }
  [[nodiscard]] bool known() const { return peer_.readersOf(pose_) == 1 && peer_.readersOf(wrench_) == 1; }
  [[nodiscard]] int targets() {
    const std::lock_guard lock(mutex_);
    return targets_;
  }
  [[nodiscard]] std::string frame() {
    const std::lock_guard lock(mutex_);
    return frame_;
  }
  [[nodiscard]] Vec3 at() {
    const std::lock_guard lock(mutex_);
    return at_m_;
  }
  [[nodiscard]] Vec3 first() {
    const std::lock_guard lock(mutex_);
    return first_m_;
  }

  Vec3 pushes_n = Vec3::Zero();

 private:
  std::mutex mutex_;
  Vec3 at_m_{0.45, 0.02, 0.3}, first_m_ = Vec3::Zero();
  std::string frame_;
  int targets_ = 0;
  FastDdsPeer peer_;
  std::size_t pose_ = 0, wrench_ = 0;
};

class Ros2ArmTest : public testing::Test {
 protected:
  Ros2ArmTest() {
    Ros2Parameters node;
    node.domain = someDomain();
    node.localhost = true;
    node_.emplace(node);
    Ros2ArmParameters arm;
    arm.base_T_site = {{0.5, 0, 0.2}, Quat(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()))};
    RobotParameters parameters;
    parameters.silence_s = 0.3;
    parameters.hold_s = 0.1;
    robot_.emplace(parameters, std::make_unique<Ros2Arm>(*node_, arm, kTick_s), kTick_s);
  }

  /// Ticks until it happens, 15 s at most.
  bool tickUntil(const std::function<bool()>& happened, bool told = true, bool commanded = true) {
    for (int i = 0; i < 15'000; ++i) {
      if (told && i % 5 == 0) {
        arm_.tell();
      }
      if (commanded && i % 20 == 0) {
        const Keyframe key{command_ += 20, {{{{0, 0, 0.05}, Quat::Identity()}, {}}, 1}};
        robot_->take(7, true, {&key, 1});
      }
      robot_->tick();
      std::this_thread::sleep_for(1ms);
      if (happened()) {
        return true;
      }
    }
    return false;
  }
  bool tickUntil(RobotState state, bool told = true, bool commanded = true) {
    return tickUntil([&] { return robot_->state() == state; }, told, commanded);
  }

  SomeRobot arm_{someDomain()};
  std::optional<Ros2Node> node_;
  std::optional<Robot> robot_;
  std::uint64_t command_ = 1000;
};

TEST_F(Ros2ArmTest, FollowsAnOperatorAndIsSafe) {
  ASSERT_TRUE(eventually([&] { return arm_.known(); }));
  // Without commands: it finds its zero and is left alone.
  ASSERT_TRUE(tickUntil(RobotState::kWaiting, true, false));
  EXPECT_EQ(arm_.targets(), 0);

  // It goes to where the operator has the tool, from where it is.
  ASSERT_TRUE(tickUntil(RobotState::kFollowing));
  EXPECT_EQ(arm_.frame(), "base_link");
  EXPECT_LT((arm_.first() - Vec3(0.45, 0.02, 0.3)).norm(), 2e-3);
  EXPECT_LT((arm_.at() - Vec3(0.5, 0, 0.25)).norm(), 2e-3);
  EXPECT_LT((robot_->tool().pose.position_m - Vec3(0, 0, 0.05)).norm(), 2e-3);

  // The remote force arrives without the sensor's bias, in the site frame, whose x is the base's y.
  arm_.pushes_n = {0, 4, 5};
  ASSERT_TRUE(tickUntil([&] { return robot_->met().force_n.norm() > 1; }));
  EXPECT_LT((robot_->met().force_n - Vec3(4, 0, 5)).norm(), 1e-9);
  EXPECT_EQ(robot_->state(), RobotState::kFollowing);

  // Its poses stop: it gets no more targets. They return: it restarts, up and across.
  ASSERT_TRUE(tickUntil(RobotState::kTaring, false));
  EXPECT_EQ(robot_->reason(), StopReason::kFault);
  const int targets = arm_.targets();
  ASSERT_FALSE(tickUntil([n = 0]() mutable { return ++n > 200; }, false) && arm_.targets() > targets + 1);
  ASSERT_TRUE(tickUntil(RobotState::kFollowing));

  // Commands stop: it holds, lifts the tool out of the soil, and is left alone.
  ASSERT_TRUE(tickUntil(RobotState::kWaiting, true, false));
  EXPECT_EQ(robot_->reason(), StopReason::kSilence);
  EXPECT_NEAR(arm_.at().z(), 0.28, 3e-3);  // 80 mm above the soil

  // Too much force.
  ASSERT_TRUE(tickUntil(RobotState::kFollowing));
  arm_.pushes_n = {0, 0, 150};
  ASSERT_TRUE(tickUntil(RobotState::kHolding));
  EXPECT_EQ(robot_->reason(), StopReason::kForce);
}

TEST(Ros2Arm, RefusesTopicsThatAreNone) {
  Ros2Parameters parameters;
  parameters.domain = someDomain();
  parameters.localhost = true;
  Ros2Node node(parameters);
  Ros2ArmParameters arm;
  arm.pose_topic = "/a b";
  EXPECT_THROW(Ros2Arm(node, arm, kTick_s), InvalidParameter);
  arm = {};
  arm.target_period_s = 0;
  EXPECT_THROW(Ros2Arm(node, arm, kTick_s), InvalidParameter);
}

TEST(Ros2Node, RefusesDomainsThatHaveNoPorts) {
  Ros2Parameters parameters;
  for (const int domain : {-1, 233}) {
    parameters.domain = domain;
    EXPECT_THROW(Ros2Node{parameters}, InvalidParameter);
  }
  parameters.domain.reset();
  for (const char* text : {"x", "1x", "-1", "300"}) {
    setenv("ROS_DOMAIN_ID", text, 1);
    EXPECT_THROW(Ros2Node{parameters}, InvalidParameter) << text;
  }
  unsetenv("ROS_DOMAIN_ID");
}

TEST(Ros2Node, AnErrorHasTheReasonThatDdsGives) {
  Ros2Parameters parameters;
  parameters.domain = someDomain();
  parameters.localhost = true;
  setenv(
      "CYCLONEDDS_URI",
      "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"no-such-0\"/></Interfaces></General></Domain>"
      "</CycloneDDS>",
      1);
  try {
    const Ros2Node node(parameters);
    ADD_FAILURE() << "there is no interface no-such-0";
  } catch (const Failure& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("no-such-0"));
  }
  unsetenv("CYCLONEDDS_URI");
}

TEST(Ros2Node, ReadsWhatMayBeDiscoveredAsRos2DoesAndRefusesOtherWords) {
  Ros2Parameters parameters;
  for (const auto& [variable, text] :
       {std::pair{"ROS_AUTOMATIC_DISCOVERY_RANGE", "localhost"}, std::pair{"ROS_AUTOMATIC_DISCOVERY_RANGE", "off"},
        std::pair{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET "}, std::pair{"ROS_LOCALHOST_ONLY", "true"}}) {
    parameters.domain = someDomain();
    setenv(variable, text, 1);
    try {
      const Ros2Node node(parameters);
      ADD_FAILURE() << variable << "=" << text << " is taken";
    } catch (const InvalidParameter& error) {
      EXPECT_EQ(error.key(), variable);
    }
    unsetenv(variable);
  }
  for (const char* text : {"OFF", "LOCALHOST"}) {
    parameters.domain = someDomain();
    setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", text, 1);
    EXPECT_NO_THROW(Ros2Node{parameters}) << text;
    unsetenv("ROS_AUTOMATIC_DISCOVERY_RANGE");
  }
}

}  // namespace
}  // namespace haptolith
