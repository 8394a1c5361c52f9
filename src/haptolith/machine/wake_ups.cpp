#include "haptolith/machine/wake_ups.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "haptolith/core/platform/clock.h"

namespace haptolith {

namespace {

/// Progress of the measuring thread, readable while it works.
struct Seen {
  std::atomic<double> elapsed_s{0}, latest_us{0};
  std::atomic<bool> done{false};
};

/// Paced as HapticLoop::run() is: a sleep that ends late is not made up for by shorter ones.
void sleepTickByTick(WakeUps& found, double tick_s, double seconds, const std::atomic<bool>& stop, Seen& seen) {
  const auto period_ns = static_cast<std::int64_t>(std::llround(1e9 * tick_s));
  const auto sleeps = static_cast<std::uint64_t>(std::llround(seconds / tick_s));
  const std::int64_t start_ns = monotonicNs();
  std::int64_t wanted_ns = start_ns;
  while (found.late_us.count() < sleeps && !stop.load(std::memory_order_relaxed)) {
    wanted_ns = std::max(wanted_ns + period_ns, monotonicNs() - period_ns);
    sleepUntilNs(wanted_ns);
    const std::int64_t late_ns = monotonicNs() - wanted_ns;
    found.late_us.add(1e-3 * static_cast<double>(late_ns));
    found.missed += late_ns >= period_ns ? 1 : 0;
    found.seconds = 1e-9 * static_cast<double>(wanted_ns + late_ns - start_ns);
    seen.elapsed_s.store(found.seconds, std::memory_order_relaxed);
    seen.latest_us.store(found.late_us.max(), std::memory_order_relaxed);
  }
}

}  // namespace

WakeUps measureWakeUps(const LoopParameters& loop, double seconds, const std::atomic<bool>& stop,
                       const WakeUpProgress& progress) {
  validate(loop);
  requireUsableCpu(loop.cpu);
  WakeUps found;
  Seen seen;
  std::jthread sleeper([&] {
    found.real_time = requestRealTime(loop);
    sleepTickByTick(found, loop.tick_s, seconds, stop, seen);
    seen.done.store(true, std::memory_order_release);
  });
  while (!seen.done.load(std::memory_order_acquire)) {
    progress(seen.elapsed_s.load(std::memory_order_relaxed), seen.latest_us.load(std::memory_order_relaxed));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  sleeper.join();
  return found;
}

}  // namespace haptolith
