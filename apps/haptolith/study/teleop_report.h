#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "haptolith/study/results/teleop_results.h"

namespace haptolith {

/// Returns the measures of blocks of teleoperation as text: means over participants, and differences from the first
/// block, paired within participants. Empty without such blocks. @param confidence  level of all intervals.
[[nodiscard]] std::string teleopTable(const StudyProtocol& protocol, const std::vector<TeleopBlockResult>& results,
                                      double confidence);

/// As above, as an array of blocks.
[[nodiscard]] nlohmann::ordered_json teleopJson(const StudyProtocol& protocol,
                                                const std::vector<TeleopBlockResult>& results, double confidence);

}  // namespace haptolith
