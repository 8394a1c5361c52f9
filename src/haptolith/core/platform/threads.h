#pragma once

#include <bitset>
#include <string_view>

namespace haptolith {

/// Pauses the processor for a moment, for a thread that polls. May be called in the tick.
inline void relax() noexcept {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ volatile("yield");
#endif
}

/// A set of processors, by their numbers.
using CpuSet = std::bitset<1024>;

/// CPUs that a thread of this process may be pinned to, also those that are kept free of other threads (isolcpus).
/// @throws Failure when there is no thread to ask. Not for the tick.
[[nodiscard]] CpuSet usableCpus();

/// CPUs that the calling thread runs on; none if the system does not say.
[[nodiscard]] CpuSet cpusOfThisThread() noexcept;

/// Lets the calling thread run on these CPUs only. Returns 0 or an error number. May be called in the tick.
int runThisThreadOn(const CpuSet& cpus) noexcept;

/// Real-time priority of the calling thread, 1 to 99; 0 for none. May be called in the tick.
[[nodiscard]] int priorityOfThisThread() noexcept;

/// Gives the calling thread that priority, and 0 takes it away. Returns 0 or an error number. May be called in the
/// tick.
int setPriorityOfThisThread(int priority) noexcept;

/// Name that the system gives to scheduling with and without real-time priority.
[[nodiscard]] std::string_view schedulerName(bool real_time) noexcept;

/// Lets the system wake the calling thread as soon as its time has come, instead of together with others.
void wakeThisThreadPromptly() noexcept;

/// Keeps all memory of this process off the disk. Returns 0 or an error number.
[[nodiscard]] int lockMemory() noexcept;

}  // namespace haptolith
