#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

#include "haptolith/teleop/operator_end.h"
#include "haptolith/viewer/messages.h"

namespace haptolith {

/// "robot following, 2650 commands behind; force felt 3.2 N, met 2.9 N": for a status line.
[[nodiscard]] std::string robotText(const RobotNews& news);

/// The same for the page.
[[nodiscard]] RobotShown robotShown(const RobotNews& news, double surface_m);

/// How it went, for the end of a run.
[[nodiscard]] std::string robotSummary(const OperatorEnd& end);
[[nodiscard]] nlohmann::ordered_json robotJson(const OperatorEnd& end);
[[nodiscard]] nlohmann::ordered_json countsJson(const PacketCounts& counts);

}  // namespace haptolith
