#include "teleop/robot_status.h"

#include <fmt/format.h>

#include "haptolith/core/counted.h"

namespace haptolith {

std::string robotStatusText(const Robot& robot, const RobotServer& server) {
  const std::string who =
      server.operatorAddress().empty() ? "no operator yet" : fmt::format("operator {}", server.operatorAddress());
  const std::string why = robot.reason() == StopReason::kNone ? "" : fmt::format(" ({})", text(robot.reason()));
  return fmt::format("{}: {}{}, command {:.0f} of {}, {:.2f} N", who, text(robot.state()), why, robot.index(),
                     robot.newest(), robot.met().force_n.norm());
}

std::string robotSummaryText(const Robot& robot, const RobotServer& server, const std::string& status) {
  const PacketCounts& counts = server.counts();
  return fmt::format(
      "  robot      {}; stopped {}\n  packets    {} taken; {} malformed, {} forged, {} replayed, {} of "
      "strangers\n",
      status, counted(robot.stops(), "time"), counts.taken, counts.malformed, counts.forged, counts.replayed,
      counts.strangers);
}

}  // namespace haptolith
