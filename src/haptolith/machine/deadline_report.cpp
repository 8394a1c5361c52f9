#include "haptolith/machine/deadline_report.h"

#include <fmt/format.h>

#include "haptolith/core/pluralise.h"

namespace haptolith {

std::string deadlinesText(const LoopStatistics& statistics) {
  const auto of = [&](Miss cause) { return statistics.misses(cause); };
  const std::string causes =
      statistics.deadlineMisses() == 0
          ? ""
          : fmt::format(": {} too long, {} woken late, {} processor taken away", pluralise(of(Miss::kTooLong), "tick"),
                        of(Miss::kWokenLate), of(Miss::kPreempted));
  return fmt::format("{} missed{}; {:.0f} % of the last 100 in time", statistics.deadlineMisses(), causes,
                     100 * statistics.successRate());
}

std::string deadlineAdvice(const LoopStatistics& statistics, std::string_view coarser) {
  const std::uint64_t soil = statistics.misses(Miss::kTooLong);
  const std::uint64_t machine = statistics.misses(Miss::kWokenLate) + statistics.misses(Miss::kPreempted);
  const auto percent = [&](std::uint64_t ticks) {
    return 100 * static_cast<double>(ticks) / static_cast<double>(statistics.ticks());
  };
  const auto written = [&](std::uint64_t ticks) {
    return percent(ticks) < 10 ? fmt::format("{:.2g} %", percent(ticks)) : fmt::format("{:.0f} %", percent(ticks));
  };
  constexpr double kWorth_percent = 100 * kMissesWorthAdvice;
  if (soil >= machine && soil > 0 && percent(soil) > kWorth_percent) {
    return fmt::format("the particles are too small for this machine: {} of ticks took too long; try: {}",
                       written(soil), coarser);
  }
  if (machine > soil && percent(machine) > kWorth_percent) {
    return fmt::format(
        "other programs or the host of a virtual machine use the CPU: {} of ticks were woken late or interrupted; see: "
        "haptolith doctor",
        written(machine));
  }
  return "";
}

}  // namespace haptolith
