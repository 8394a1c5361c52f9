#pragma once

#include <string>
#include <string_view>

#include "haptolith/haptics/loop/loop_statistics.h"

namespace haptolith {

/// Share of missed ticks from which a run ends with advice.
inline constexpr double kMissesWorthAdvice = 1e-3;

/// "3 missed: 1 tick too long, 2 woken late, 0 processor taken away; 98 % of the last 100 in time".
[[nodiscard]] std::string deadlinesText(const LoopStatistics& statistics);

/// One line of advice when a run in real time missed more than kMissesWorthAdvice of its ticks; empty
/// otherwise.
/// @param coarser  command that opens the same scene with coarser soil.
[[nodiscard]] std::string deadlineAdvice(const LoopStatistics& statistics, std::string_view coarser);

}  // namespace haptolith
