#pragma once

#include <cstdint>

namespace haptolith {

/// Nanoseconds of the monotonic clock. May be called in the tick.
[[nodiscard]] std::int64_t monotonicNs() noexcept;

/// Nanoseconds since 1970 by the clock on the wall, which may be set. May be called in the tick.
[[nodiscard]] std::int64_t wallClockNs() noexcept;

/// Nanoseconds that the calling thread has run on a processor, without those that the host of a virtual machine is
/// known to have taken; 0 where the system does not count them. Costs a system call of 0.4 us. May be called in the
/// tick.
[[nodiscard]] std::int64_t threadCpuNs() noexcept;

/// Sleeps until the monotonic clock shows `deadline_ns`; returns at once when that is past. Absolute, so that the time
/// spent between two calls does not add up. May be called in the tick's thread, between ticks.
void sleepUntilNs(std::int64_t deadline_ns) noexcept;

}  // namespace haptolith
