#include "haptolith/ros2/ros2_name.h"

#include <gmock/gmock.h>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

TEST(Ros2Name, IsPutBeforePrivateAndRelativeTopics) {
  const Ros2Name name{.node = "digger", .node_namespace = "/site/left"};
  EXPECT_EQ(name.topic("~/wrench"), "/site/left/digger/wrench");
  EXPECT_EQ(name.topic("scan"), "/site/left/scan");
  EXPECT_EQ(name.topic("/tf"), "/tf");
  EXPECT_EQ(Ros2Name().topic("~/wrench"), "/haptolith/wrench");
  EXPECT_EQ(ddsTopic("/haptolith/wrench"), "rt/haptolith/wrench");
}

TEST(Ros2Name, ThatRos2DoesNotTakeIsRefused) {
  for (const char* node : {"", "2nd", "my node", "a/b", "h\u00e4nd"}) {
    EXPECT_THROW(validate(Ros2Name{.node = node}), InvalidParameter) << node;
  }
  for (const char* above : {"", "site", "/site/", "//", "/2", "/a b"}) {
    EXPECT_THROW(validate(Ros2Name{.node_namespace = above}), InvalidParameter) << above;
  }
  for (const char* topic : {"", "/", "~/", "a-b", "/a//b", "/a/"}) {
    EXPECT_THROW((void)Ros2Name().topic(topic), InvalidParameter) << topic;
  }
  EXPECT_NO_THROW(validate(Ros2Name{.node = "_a1", .node_namespace = "/site/left"}));
}

}  // namespace
}  // namespace haptolith
