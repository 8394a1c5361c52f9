#include "haptolith/core/platform/clock.h"

#include <cerrno>
#include <ctime>

namespace haptolith {

namespace {
constexpr std::int64_t kNsPerSecond = 1'000'000'000;
}

std::int64_t monotonicNs() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kNsPerSecond + now.tv_nsec;
}

std::int64_t wallClockNs() noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return now.tv_sec * kNsPerSecond + now.tv_nsec;
}

std::int64_t threadCpuNs() noexcept {
  timespec run{};
  return clock_gettime(CLOCK_THREAD_CPUTIME_ID, &run) == 0 ? run.tv_sec * kNsPerSecond + run.tv_nsec : 0;
}

void sleepUntilNs(std::int64_t deadline_ns) noexcept {
  timespec until{};
  until.tv_sec = deadline_ns / kNsPerSecond;
  until.tv_nsec = deadline_ns % kNsPerSecond;
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace haptolith
