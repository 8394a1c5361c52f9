#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "haptolith/study/results/teleop_results.h"

namespace haptolith {

/// Means over people of what was measured in blocks of work for a robot, and how much more it was than in the first of
/// them, paired within people. Empty when there is none. @param confidence  of all intervals.
[[nodiscard]] std::string teleopTable(const StudyProtocol& protocol, const std::vector<TeleopBlockResult>& results,
                                      double confidence);

/// The same as an array of blocks.
[[nodiscard]] nlohmann::ordered_json teleopJson(const StudyProtocol& protocol,
                                                const std::vector<TeleopBlockResult>& results, double confidence);

}  // namespace haptolith
