#include "haptolith/teleop/robot/site_robot.h"

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <span>
#include <thread>

#include "haptolith/core/error.h"
#include "haptolith/teleop/operator/operator_end.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;

bool soon(const std::function<bool()>& is_so) {
  for (int i = 0; i < 10'000; ++i) {
    if (is_so()) {
      return true;
    }
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

TEST(RobotBehindLink, FollowsAnOperatorWhoHearsOfItADelayLater) {
  const SceneFile site;
  LinkParameters way;
  way.delay_s = 0.15;
  RobotBehindLink robot(site, std::make_unique<Scene>(site.bed, site.tool), way, way);
  ASSERT_TRUE(soon([&] { return robot.isReady(); })) << "its sensor needs half a second";
  OperatorEnd end(robot.address(), {}, 0, site.loop.tick_s);
  TickRecord tick;
  tick.scene_T_tool.position_m = {0, 0, 0.1};
  EXPECT_TRUE(soon([&] {
    end.follow(std::span(&tick, 1));
    end.receive();
    return end.news().state.state == RobotState::kFollowing;
  }));
  EXPECT_GE(end.news().round_trip_s, 0.3);
  EXPECT_LT(end.news().round_trip_s, 1);
  EXPECT_EQ(robot.problem(), "");
  EXPECT_FALSE(end.site().empty()) << "it shows its soil";
}

TEST(RobotBehindLink, RefusesALinkThatThereCannotBe) {
  const SceneFile site;
  LinkParameters way;
  way.delay_s = -1;
  EXPECT_THROW(RobotBehindLink(site, std::make_unique<Scene>(site.bed, site.tool), way, way), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
