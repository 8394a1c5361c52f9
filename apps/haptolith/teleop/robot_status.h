#pragma once

#include <string>

#include "haptolith/teleop/robot/robot_server.h"

namespace haptolith {

/// Returns "3 malformed (the first: 57 bytes of text, ...)".
[[nodiscard]] std::string malformedCountText(const PacketCounts& counts);

/// Returns "operator 127.0.0.1:40000: following, command 1200 of 1300, 2.31 N".
[[nodiscard]] std::string robotStatusText(const Robot& robot, const RobotServer& server);

/// Returns the final summary, with the last state of the robot.
[[nodiscard]] std::string robotSummaryText(const Robot& robot, const RobotServer& server, const std::string& status);

}  // namespace haptolith
