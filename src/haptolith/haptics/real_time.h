#pragma once

#include <string>
#include <string_view>

#include "haptolith/core/platform/threads.h"
#include "haptolith/core/process/worker_team.h"
#include "haptolith/haptics/loop_parameters.h"

namespace haptolith {

/// Priority of the loop's thread: above ordinary real-time work, below the kernel's own threads.
inline constexpr int kRealTimePriority = 80;

/// Command that grants more from the next login on.
inline constexpr std::string_view kPriorityRemedy =
    R"(echo "$USER - rtprio 80" | sudo tee -a /etc/security/limits.d/haptolith.conf, then log in again)";
inline constexpr std::string_view kMemoryRemedy =
    R"(echo "$USER - memlock unlimited" | sudo tee -a /etc/security/limits.d/haptolith.conf, then log in again)";

/// Privileges that the system granted to the calling thread.
struct RealTime {
  std::string scheduler{schedulerName(false)};  ///< on Linux "SCHED_FIFO" when granted
  bool memory_locked = false;
  int cpu = kAnyCpu;     ///< the only one that it runs on
  std::string advice{};  ///< empty when all was granted; else one line with the missing privilege and its remedy
};

/// @throws InvalidParameter unless `cpu` is kAnyCpu or the number of a CPU that this process may use: an isolated one,
/// and one that taskset has left out, it may; one outside its control group it may not. Not for the tick.
void requireUsableCpu(int cpu);

/// Makes the calling thread ready for the loop: pins it to the CPU that the parameters name and, when they ask for real
/// time, asks for SCHED_FIFO and, unless told not to, locked memory. Reports the result. Call before the first tick.
[[nodiscard]] RealTime requestRealTime(const LoopParameters& loop, bool lock_memory = true);

/// Scheduling of threads that help the calling one in its ticks: with a real-time priority one less than its
/// own, so that they never keep it waiting, and none where it has none; and off the CPU that it is pinned to. A helper
/// on the processor that a real-time thread keeps is left waiting there, though others are free.
[[nodiscard]] HelperSchedule helpersSchedule() noexcept;

}  // namespace haptolith
