#include "haptolith/machine/machine_summary.h"

#include <fmt/format.h>

#include <algorithm>

#include "haptolith/core/pluralise.h"
#include "haptolith/machine/real_time_checks.h"

namespace haptolith {

namespace {

std::string soilText(const std::optional<FinestSoil>& soil) {
  if (!soil) {
    return "not measured: interrupted";
  }
  const std::string what = fmt::format("R = {:.3g} mm (about {} particles, {})", 1e3 * soil->radius_m, soil->particles,
                                       pluralise(soil->threads, "thread"));
  return soil->in_time ? fmt::format("{}: 99 % of ticks within {:.0f} us", what, soil->tick_us_p99)
                       : fmt::format("none; even {} is too slow", what);
}

std::string coresText(const std::vector<Check>& checks) {
  const auto cpus = std::ranges::find(checks, kCpuCheck, &Check::name);
  return cpus == checks.end() ? "unknown" : cpus->found;
}

std::string wakeUpsText(const WakeUps& measured) {
  const Histogram& late_us = measured.late_us;
  return late_us.count() == 0 ? "not measured: interrupted"
                              : fmt::format(
                                    "{:.2g} % a tick late or more, and no loop here misses fewer ticks; 99.9 % "
                                    "within {:.0f} us",
                                    100 * static_cast<double>(measured.missed) / static_cast<double>(late_us.count()),
                                    late_us.percentile(0.999));
}

/// The first remedy of the worst checks. Late wake-ups come last: they follow from the others.
std::string changeText(const std::vector<Check>& checks, const std::optional<FinestSoil>& soil) {
  const Check* first = nullptr;
  for (const Check& check : checks) {
    const bool follows = first != nullptr && check.name == kWakeUpCheck;
    if (!check.remedy.empty() && !follows && (first == nullptr || check.verdict > first->verdict)) {
      first = &check;
    }
  }
  if (first != nullptr) {
    return fmt::format("{}: {}", first->name, first->remedy);
  }
  return soil && !soil->in_time ? "a smaller box, or a machine with more or faster cores" : "nothing";
}

}  // namespace

std::vector<SummaryLine> machineSummary(const std::vector<Check>& checks, const WakeUps& measured,
                                        const std::optional<FinestSoil>& soil) {
  const RealTime& granted = measured.real_time;
  return {
      {"finest soil", soilText(soil)},
      {"cores", coresText(checks)},
      {"priority", fmt::format("{}, memory {}", granted.scheduler, granted.memory_locked ? "locked" : "not locked")},
      {"late wake-ups", wakeUpsText(measured)},
      {"to change", changeText(checks, soil)}};
}

}  // namespace haptolith
