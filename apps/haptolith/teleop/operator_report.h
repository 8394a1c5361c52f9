#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

#include "haptolith/viewer/messages.h"

#include "teleop/robot_lead.h"

namespace haptolith {

/// Returns a status line: "robot following, 2650 commands behind, round trip 2.60 s; the robot met 2.90 N, this soil
/// 3.20 N".
[[nodiscard]] std::string robotText(const RobotLead& robot);

/// Returns "34.2 (31 to 37) deg, 150 (90 to 240) Pa, soil-tool 18.1 (15 to 21) deg".
[[nodiscard]] std::string soilText(const ModelSoil& soil);

/// Returns the robot's state for the page.
[[nodiscard]] RobotShown robotShown(const RobotLead& robot);

/// Returns the summary at the end of a run.
[[nodiscard]] std::string robotSummary(const RobotLead& robot);
[[nodiscard]] nlohmann::ordered_json robotJson(const RobotLead& robot);
[[nodiscard]] nlohmann::ordered_json countsJson(const PacketCounts& counts);

}  // namespace haptolith
