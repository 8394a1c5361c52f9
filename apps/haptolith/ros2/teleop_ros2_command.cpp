#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/haptics/loop/loop_clock.h"
#include "haptolith/ros2/ros2_arm.h"
#include "haptolith/teleop/robot/robot_server.h"

#include "ros2/ros2_options.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/stop_on_signal.h"
#include "teleop/operator_report.h"
#include "teleop/robot_status.h"
#include "teleop/teleop_commands.h"
#include "teleop/teleop_end_options.h"

namespace haptolith {

namespace {

constexpr const char* kTeleopRos2Examples = R"(Examples:
  haptolith teleop ros2 --robot /arm --site 0.5,0,0.1,90
                                              publish /arm/target_pose; subscribe to
                                              /arm/tool_pose and /arm/wrench
  haptolith teleop operator --connect 127.0.0.1:7410
                                              lead the robot, in another terminal

  haptolith ros2 teleop-site --node-name robot
                                              simulate the robot, with its own soil
  haptolith teleop ros2 --site 0,0,0.048,0    connect it; it prints the height of its surface

Frames and the limits of robot safety: docs/how-to/ros2.md.)";

struct GatewayOptions {
  Ros2Options ros2;
  std::string robot_name = "/robot", target, pose, wrench;
  std::vector<double> site{0, 0, 0, 0};
  Ros2ArmParameters arm;
  std::string listen = EndOptions().listen;
  TeleopEndOptions end;
  RobotParameters robot;
  double duration_s = 0;
  bool json = false;
};

void runGateway(const GatewayOptions& options) {
  constexpr double kTick_s = 1e-3;
  constexpr double kDegree = std::numbers::pi / 180;
  const StopOnSignal stop;
  EndOptions end = options.end.end();
  end.listen = options.listen;
  requireSafe("listen", end.listen, end);
  Ros2ArmParameters arm = options.arm;
  const auto topic = [&](const std::string& asked, const char* usual) {
    return asked.empty() ? options.robot_name + "/" + usual : asked;
  };
  arm.target_topic = topic(options.target, "target_pose");
  arm.pose_topic = topic(options.pose, "tool_pose");
  arm.wrench_topic = topic(options.wrench, "wrench");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    requireInRange(fmt::format("site[{}]", axis), options.site[axis], {-100, 100});
    arm.base_T_site.position_m[static_cast<Eigen::Index>(axis)] = options.site[axis];
  }
  arm.base_T_site.orientation =
      Eigen::AngleAxisd(kDegree * requireInRange("site[3]", options.site[3], {-360, 360}), Vec3::UnitZ());
  Ros2Node node(options.ros2.node);
  Robot robot(options.robot, std::make_unique<Ros2Arm>(node, arm, kTick_s), kTick_s);
  RobotServer server(robot, end, kTick_s);
  printNotice(fmt::format("ROS 2 node {}: operators at port {}{}, a robot at {}; Ctrl-C ends it\n", node.text(),
                          server.port(), end.key.empty() ? "" : ", with a key", arm.target_topic));
  StatusLine status;
  LoopClock clock(kTick_s, true);
  clock.start();
  const double ticks = options.duration_s > 0 ? options.duration_s / kTick_s : -1;
  for (std::uint64_t tick = 0; !stopAsked() && (ticks < 0 || static_cast<double>(tick) < ticks); ++tick) {
    (void)clock.waitForTick();
    clock.beginTick();
    server.receive();
    robot.tick();
    server.answer();
    clock.endTick();
    clock.planNextTick();
    if (status.visible()) {
      status.update(robotStatusText(robot, server));
    }
  }
  status.clear();
  if (options.json) {
    printJson({{"node", node.text()},
               {"state", text(robot.state())},
               {"reason", text(robot.reason())},
               {"stops", robot.stops()},
               {"ran_out", robot.ranOut()},
               {"packets", countsJson(server.counts())}});
  } else {
    printText(robotSummaryText(robot, server, robotStatusText(robot, server)));
  }
}

}  // namespace

void addTeleopRos2(CLI::App& teleop) {
  auto options = std::make_shared<GatewayOptions>();
  options->ros2.node.name.node = "haptolith_gateway";
  CLI::App* command = teleop.add_subcommand("ros2", "Connect a ROS 2 robot to `haptolith teleop operator`");
  command->footer(kTeleopRos2Examples);
  const auto text = [&](const char* name, std::string& value, const char* what) {
    command->add_option(name, value, what)->option_text("/TOPIC");
  };
  text("--robot", options->robot_name, "Prefix of the robot's topics [/robot]");
  text("--target-topic", options->target, "Topic of the target pose, PoseStamped [/robot/target_pose]");
  text("--pose-topic", options->pose, "Topic of the tool pose, PoseStamped [/robot/tool_pose]");
  text("--wrench-topic", options->wrench, "Topic of the soil wrench on the tool, WrenchStamped [/robot/wrench]");
  command
      ->add_option("--site", options->site,
                   "Centre of the soil's surface in the frame of the poses, and rotation about z")
      ->delimiter(',')
      ->expected(4)
      ->option_text("X_M,Y_M,Z_M,YAW_DEG [0,0,0,0]");
  command->add_flag("--wrench-of-tool", options->arm.wrench_of_tool,
                    "The sensor measures the wrench of the tool on the soil, not of the soil on the tool");
  command->add_option("--listen", options->listen, "Address to listen on for commands")
      ->option_text("HOST:PORT [127.0.0.1:7410]");
  options->end.addTo(*command);
  options->ros2.addTo(*command);
  const auto number = [&](const char* name, double& value, const Range& range, const char* unit, const char* what) {
    command->add_option(name, value, fmt::format("{} [{:g}]", what, value))->option_text(unit)->check(numberIn(range));
  };
  number("--target-period-s", options->arm.target_period_s, Ros2ArmParameters::kTargetPeriod_s, "SECONDS",
         "Time between two targets");
  number("--robot-timeout-s", options->arm.fresh_s, Ros2ArmParameters::kFresh_s, "SECONDS",
         "Time without the robot's pose or wrench after which it stops");
  number("--stop-force-n", options->robot.stop_force_n, RobotRanges::force_n, "N",
         "Measured force above which the robot stops");
  number("--max-speed-m-s", options->robot.max_speed_m_s, RobotRanges::speed_m_s, "M/S", "Largest speed of the target");
  number("--silence-s", options->robot.silence_s, RobotRanges::time_s, "SECONDS",
         "Time without a command after which the tool is lifted");
  number("--duration-s", options->duration_s, LinkRanges::time_s, "SECONDS", "Duration; 0: until Ctrl-C");
  addJson(*command, options->json);
  command->callback([options] { runGateway(*options); });
}

}  // namespace haptolith
