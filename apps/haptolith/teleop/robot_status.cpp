#include "teleop/robot_status.h"

#include <fmt/format.h>

#include "haptolith/core/pluralise.h"

namespace haptolith {

std::string malformedCountText(const PacketCounts& counts) {
  return counts.malformed == 0 ? "0 malformed"
                               : fmt::format("{} malformed (the first: {})", counts.malformed, counts.first_malformed);
}

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
      "  robot      {}; stopped {}\n  packets    {} accepted; {}, {} forged, {} replayed, {} from strangers\n", status,
      pluralise(robot.stops(), "time"), counts.taken, malformedCountText(counts), counts.forged, counts.replayed,
      counts.strangers);
}

}  // namespace haptolith
