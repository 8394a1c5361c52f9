#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/machine/check.h"
#include "haptolith/machine/wake_ups.h"

namespace haptolith {

/// The finest soil of a scene that this machine computes in time.
struct FinestSoil {
  double radius_m = 0;        ///< radius of its particles
  std::size_t particles = 0;  ///< approximate number
  int threads = 1;            ///< that share a tick's work
  double tick_us_p99 = 0;     ///< predicted
  bool in_time = true;        ///< false: even the coarsest soil takes longer than a tick may
};

/// A line of the summary: "cores", "2 for this process".
struct SummaryLine {
  std::string name, text;
};

/// Capabilities of this machine, in five lines: finest soil, cores, priority, late wake-ups, what to change.
/// @param checks  from realTimeChecks().
/// @param soil    none: it has not been measured.
[[nodiscard]] std::vector<SummaryLine> machineSummary(const std::vector<Check>& checks, const WakeUps& measured,
                                                      const std::optional<FinestSoil>& soil);

}  // namespace haptolith
