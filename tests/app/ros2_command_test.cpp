#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "program.h"

namespace haptolith {
namespace {

using nlohmann::json;
using testing::HasSubstr;

bool isBuiltIn() {
  return runHaptolith("ros2 --help").output.find("--ros-namespace") != std::string::npos;
}

TEST(Ros2Command, WithoutDdsSaysWhatToInstall) {
  if (isBuiltIn()) {
    GTEST_SKIP() << "this program has DDS";
  }
  for (const char* command : {"ros2", "ros2 teleop-model --domain 3", "teleop ros2"}) {
    const ProgramResult result = runHaptolith(command);
    EXPECT_EQ(result.exit_status, 1) << command;
    EXPECT_THAT(result.errors, HasSubstr("cyclonedds-dev"));
  }
}

TEST(Ros2Command, RefusesNamesAndDomainsThatRos2DoesNotTake) {
  if (!isBuiltIn()) {
    GTEST_SKIP() << "this program has no DDS";
  }
  for (const char* wrong :
       {"ros2 --node-name 2nd", "ros2 --ros-namespace site", "ros2 --domain 233", "ros2 --target-timeout-s 0",
        "ros2 --no-realtime --duration-s 1", "teleop ros2 --robot 'a b' --listen 127.0.0.1:0", "teleop ros2 --site 1,2",
        "teleop ros2 --listen 0.0.0.0:0"}) {
    EXPECT_EQ(runHaptolith(std::string(wrong) + " --localhost").exit_status, 2) << wrong;
  }
  EXPECT_EQ(runInShell("ROS_DOMAIN_ID=x \"$HAPTOLITH\" ros2 --localhost").exit_status, 2);
}

TEST(Ros2Command, TellsWhatItTold) {
  if (!isBuiltIn()) {
    GTEST_SKIP() << "this program has no DDS";
  }
  const ProgramResult result = runHaptolith(
      "ros2 icra2021 --motion stir --localhost --domain 97 --node-name digger --ros-namespace /site --duration-s 0.5 "
      "--json");
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json told = json::parse(result.output).at("ros2");
  EXPECT_EQ(told["node"], "/site/digger in domain 97");
  EXPECT_EQ(told["ticks_told"].get<int>() + told["ticks_not_told"].get<int>(), 500);
  EXPECT_GE(told["surfaces"].get<int>(), 1);
}

TEST(Ros2Command, AToolThatWaitsForTargetsFeelsNothing) {
  if (!isBuiltIn()) {
    GTEST_SKIP() << "this program has no DDS";
  }
  const ProgramResult result = runHaptolith("ros2 icra2021 --localhost --domain 98 --duration-s 0.3 --json");
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_EQ(json::parse(result.output)["force_n"]["max"], 0);
  EXPECT_THAT(result.errors, HasSubstr("the tool waits for /haptolith/target_pose"));
}

}  // namespace
}  // namespace haptolith
