#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include "haptolith/core/histogram.h"
#include "haptolith/haptics/real_time.h"

namespace haptolith {

/// Wake-up latency of a thread that only sleeps until the next tick: a lower bound for any loop on this machine.
struct WakeUps {
  RealTime real_time;        ///< privileges of its thread
  Histogram late_us{0.1};    ///< one value for each sleep
  std::uint64_t missed = 0;  ///< sleeps that ended a whole tick late or later
  double seconds = 0;        ///< duration of the measurement
};

/// Receives the elapsed time of the measurement, in s, and the latest wake-up so far, in us.
using WakeUpProgress = std::function<void(double elapsed_s, double latest_us)>;

/// Sleeps tick by tick for `seconds` on a thread set up as the loop's would be, and reports its latency. Ends early
/// when `stop` becomes true. `progress` is called on the calling thread. Not for the tick.
/// @param loop  its tick_s and cpu count; @throws InvalidParameter as validate() and requireUsableCpu().
[[nodiscard]] WakeUps measureWakeUps(const LoopParameters& loop, double seconds, const std::atomic<bool>& stop,
                                     const WakeUpProgress& progress);

}  // namespace haptolith
