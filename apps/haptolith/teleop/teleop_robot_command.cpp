#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/platform/clock.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/haptics/loop/loop_clock.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/teleop/robot/site_robot.h"

#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/scene_options.h"
#include "shared/stop_on_signal.h"
#include "teleop/operator_report.h"
#include "teleop/robot_status.h"
#include "teleop/teleop_commands.h"
#include "teleop/teleop_end_options.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kTeleopRobotExamples = R"(Examples:
  haptolith teleop robot                                robot in teleop-site, at 127.0.0.1:7410
  haptolith teleop operator --connect 127.0.0.1:7410    control it, in another terminal
  haptolith teleop robot regolith --max-force-n 20
  haptolith teleop robot --listen 0.0.0.0:7410 --key-file teleop.key
                              make the key: openssl rand -hex 32 > teleop.key

Another robot can use the packets of docs/reference/teleop-packets.md,
with include/haptolith/teleop.h in C or examples/teleop_robot.py in Python.)";

struct RobotOptions {
  std::string site = "teleop-site";
  std::vector<std::string> overrides;
  std::string listen = EndOptions().listen;
  TeleopEndOptions end;
  RobotParameters robot;
  double duration_s = 0;
  bool json = false;
};

/// Speed of the robot's time over the last seconds.
class Rate {
 public:
  explicit Rate(double tick_s) : tick_s_(tick_s) {}

  void tick() {
    constexpr std::int64_t kOver_ns = 2'000'000'000;
    ++ticks_;
    const std::int64_t now_ns = monotonicNs();
    if (now_ns - since_ns_ >= kOver_ns) {
      value_ = static_cast<double>(ticks_) * tick_s_ * 1e9 / static_cast<double>(now_ns - since_ns_);
      since_ns_ = now_ns;
      ticks_ = 0;
    }
  }
  [[nodiscard]] double value() const noexcept { return value_; }

 private:
  double tick_s_, value_ = 1;
  std::int64_t since_ns_ = monotonicNs(), ticks_ = 0;
};

std::string statusText(const Robot& robot, const RobotServer& server, double rate) {
  constexpr double kSlow = 0.97;
  const std::string slow =
      rate < kSlow ? fmt::format("; this machine is too slow for it: {:.0f} % of real time", 100 * rate) : "";
  return robotStatusText(robot, server) + slow;
}

void runRobot(const RobotOptions& options) {
  const StopOnSignal stop;
  StatusLine status;
  SceneFile scene_file = findSceneFile(options.site, options.overrides);
  validate(scene_file);
  EndOptions end = options.end.end();
  end.listen = options.listen;
  requireSafe("listen", end.listen, end);
  requireOneTool(scene_file, "a robot");
  auto scene = std::make_unique<Scene>(scene_file.bed, scene_file.tool, settlingIn(status));
  SiteRobot site(scene_file, std::move(scene), options.robot, end);
  const Robot& robot = site.robot();
  const RobotServer& server = site.server();
  const double tick_s = scene_file.loop.tick_s;
  status.clear();
  printNotice(fmt::format("a robot in '{}', at port {}{}; Ctrl-C ends it\n", scene_file.title, server.port(),
                          end.key.empty() ? "" : ", with a key"));
  LoopClock clock(tick_s, true);
  Rate rate(tick_s);
  clock.start();
  const double ticks = options.duration_s > 0 ? options.duration_s / tick_s : -1;
  for (std::uint64_t tick = 0; !stopAsked() && (ticks < 0 || static_cast<double>(tick) < ticks); ++tick) {
    (void)clock.waitForTick();
    clock.beginTick();
    site.tick();
    clock.endTick();
    clock.planNextTick();
    rate.tick();
    if (status.visible()) {
      status.update(statusText(robot, server, rate.value()));
    }
  }
  status.clear();
  const PacketCounts& counts = server.counts();
  if (options.json) {
    printJson({{"state", text(robot.state())},
               {"reason", text(robot.reason())},
               {"stops", robot.stops()},
               {"ran_out", robot.ranOut()},
               {"real_time_share", rate.value()},
               {"packets", countsJson(counts)}});
    return;
  }
  printText(robotSummaryText(robot, server, statusText(robot, server, rate.value())));
}

}  // namespace

void addTeleopRobot(CLI::App& teleop) {
  auto options = std::make_shared<RobotOptions>();
  CLI::App* command =
      teleop.add_subcommand("robot", "Run a simulated robot that is controlled by `haptolith teleop operator`");
  command->footer(kTeleopRobotExamples);
  command->add_option("site", options->site, "Scene of the robot's site [teleop-site]")->option_text("SCENE");
  command->add_option("--set", options->overrides, kSetHelp)->option_text("TABLE.KEY=VALUE");
  command->add_option("--listen", options->listen, "Address to listen on for commands")
      ->option_text("HOST:PORT [127.0.0.1:7410]");
  options->end.addTo(*command);
  const auto number = [&](const char* name, double& value, const Range& range, const char* unit, const char* what) {
    command->add_option(name, value, fmt::format("{} [{:g}]", what, value))->option_text(unit)->check(numberIn(range));
  };
  number("--max-force-n", options->robot.max_force_n, RobotRanges::force_n, "N", "Largest force on the tool");
  number("--stop-force-n", options->robot.stop_force_n, RobotRanges::force_n, "N",
         "Measured force above which the robot stops");
  number("--max-speed-m-s", options->robot.max_speed_m_s, RobotRanges::speed_m_s, "M/S", "Largest speed of the tool");
  number("--silence-s", options->robot.silence_s, RobotRanges::time_s, "SECONDS",
         "Time without a command after which the tool is lifted");
  number("--duration-s", options->duration_s, LinkRanges::time_s, "SECONDS", "Duration; 0: until Ctrl-C");
  addJson(*command, options->json);
  command->callback([options] { runRobot(*options); });
}

}  // namespace haptolith
