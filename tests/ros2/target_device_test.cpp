#include "haptolith/ros2/target_device.h"

#include <gmock/gmock.h>

#include <limits>
#include <thread>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/clock.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;

constexpr double kTick_s = 1e-3;
const TargetParameters kParameters{.fresh_s = 0.1, .low_m = {-0.2, -0.2, 0}, .high_m = {0.2, 0.2, 0.5}};

class TargetDeviceTest : public testing::Test {
 protected:
  void want(const Vec3& position_m, double age_s = 0) {
    inbox_->draft() = {{position_m, Quat::Identity()}, monotonicNs() - std::int64_t(1e9 * age_s)};
    inbox_->publish();
  }
  /// Pose of the handle after a number of ticks; the target stays fresh.
  DeviceInput follow(const Vec3& position_m, int ticks) {
    DeviceInput input;
    for (int i = 0; i < ticks; ++i) {
      want(position_m);
      input = device_.read();
      device_.write({});
    }
    return input;
  }

  std::shared_ptr<TargetInbox> inbox_ = std::make_shared<TargetInbox>();
  TargetDevice device_{inbox_, kParameters, HandParameters(), kTick_s};
};

TEST_F(TargetDeviceTest, IsStaleUntilATargetComes) {
  EXPECT_EQ(device_.read().state, DeviceState::kStale);
  want({0, 0, 0.1});
  EXPECT_EQ(device_.read().state, DeviceState::kLive);
}

TEST_F(TargetDeviceTest, ComesToTheTargetAndRestsThere) {
  const DeviceInput input = follow({0.05, -0.03, 0.2}, 2000);
  EXPECT_LT((input.pose.position_m - Vec3(0.05, -0.03, 0.2)).norm(), 1e-4);
  EXPECT_LT(input.twist.linear_m_s.norm(), 1e-3);
}

TEST_F(TargetDeviceTest, MovesSmoothlyAfterATargetThatJumps) {
  follow({0, 0, 0.1}, 2000);
  Vec3 before = device_.read().pose.position_m;
  for (int i = 0; i < 500; ++i) {
    const Vec3 now = follow({0.15, 0, 0.1}, 1).pose.position_m;
    EXPECT_LT((now - before).norm(), 5e-3);  // 5 m/s: half of what a hand does at the fastest
    before = now;
  }
}

TEST_F(TargetDeviceTest, StaysWhereItIsWhenTheTargetGrowsOld) {
  follow({0, 0, 0.1}, 2000);
  const DeviceInput live = device_.read();
  want({0.1, 0, 0.1}, 0.11);
  const DeviceInput stale = device_.read();
  EXPECT_EQ(stale.state, DeviceState::kStale);
  EXPECT_EQ(stale.pose.position_m, live.pose.position_m);
  EXPECT_TRUE(stale.twist.linear_m_s.isZero(0));
  EXPECT_EQ(follow({0, 0, 0.1}, 1).state, DeviceState::kLive);
}

TEST_F(TargetDeviceTest, FollowsTargetsBeyondItsSpaceToTheEdge) {
  const DeviceInput input = follow({1e9, 0, -5}, 3000);
  EXPECT_LT((input.pose.position_m - Vec3(0.2, 0, 0)).norm(), 1e-3);
}

TEST_F(TargetDeviceTest, YieldsToTheSoil) {
  follow({0, 0, 0.1}, 2000);
  DeviceInput input;
  for (int i = 0; i < 2000; ++i) {
    want({0, 0, 0.05});
    input = device_.read();
    device_.write({.wrench = {{0, 0, 5}, Vec3::Zero()}, .gripper_force_n = 0});
  }
  EXPECT_GT(input.pose.position_m.z(), 0.06);
}

TEST(TargetDevice, RefusesATimeoutOutOfRange) {
  for (const double fresh_s : {0.0, -1.0, 11.0, std::numeric_limits<double>::quiet_NaN()}) {
    TargetParameters parameters = kParameters;
    parameters.fresh_s = fresh_s;
    EXPECT_THROW(TargetDevice(std::make_shared<TargetInbox>(), parameters, HandParameters(), kTick_s),
                 InvalidParameter);
  }
}

}  // namespace
}  // namespace haptolith
