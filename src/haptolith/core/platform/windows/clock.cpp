#include "haptolith/core/platform/clock.h"

#include <windows.h>

namespace haptolith {

namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr DWORD kHighResolution = 2;  // CREATE_WAITABLE_TIMER_HIGH_RESOLUTION, which older headers lack

/// Timer of the calling thread. The ordinary one would wake it up to 15 ms late.
class Timer {
 public:
  Timer() noexcept : timer_(CreateWaitableTimerExW(nullptr, nullptr, kHighResolution, TIMER_ALL_ACCESS)) {
    if (timer_ == nullptr) {  // Windows 10 before 1803
      timer_ = CreateWaitableTimerExW(nullptr, nullptr, 0, TIMER_ALL_ACCESS);
    }
  }
  ~Timer() {
    if (timer_ != nullptr) {
      CloseHandle(timer_);
    }
  }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

  void wait(std::int64_t ns) const noexcept {
    LARGE_INTEGER due{};
    due.QuadPart = -(ns + 99) / 100;  // from now on
    if (timer_ == nullptr || SetWaitableTimer(timer_, &due, 0, nullptr, nullptr, FALSE) == 0) {
      Sleep(static_cast<DWORD>((ns + 999'999) / 1'000'000));
      return;
    }
    WaitForSingleObject(timer_, INFINITE);
  }

 private:
  HANDLE timer_;
};

std::int64_t frequencyHz() noexcept {
  LARGE_INTEGER frequency{};
  QueryPerformanceFrequency(&frequency);
  return frequency.QuadPart;
}

}  // namespace

std::int64_t monotonicNs() noexcept {
  static const std::int64_t frequency_hz = frequencyHz();
  LARGE_INTEGER now{};
  QueryPerformanceCounter(&now);
  // In two parts, as the product would overflow after 15 minutes.
  return now.QuadPart / frequency_hz * kNsPerSecond + now.QuadPart % frequency_hz * kNsPerSecond / frequency_hz;
}

std::int64_t wallClockNs() noexcept {
  constexpr std::int64_t kFrom1601To1970 = 116'444'736'000'000'000;  // in steps of 100 ns
  FILETIME now{};
  GetSystemTimePreciseAsFileTime(&now);
  return 100 *
         (static_cast<std::int64_t>(std::uint64_t{now.dwHighDateTime} << 32U | now.dwLowDateTime) - kFrom1601To1970);
}

std::int64_t threadCpuNs() noexcept {
  FILETIME made{};
  FILETIME ended{};
  FILETIME kernel{};
  FILETIME user{};
  if (GetThreadTimes(GetCurrentThread(), &made, &ended, &kernel, &user) == 0) {
    return 0;
  }
  const auto ns = [](const FILETIME& time) {
    return 100 * static_cast<std::int64_t>(std::uint64_t{time.dwHighDateTime} << 32U | time.dwLowDateTime);
  };
  return ns(kernel) + ns(user);
}

void sleepUntilNs(std::int64_t deadline_ns) noexcept {
  static thread_local const Timer timer;
  for (std::int64_t left_ns = 0; (left_ns = deadline_ns - monotonicNs()) > 0;) {
    timer.wait(left_ns);
  }
}

}  // namespace haptolith
