#include "haptolith/haptics/watchdog.h"

#include <cmath>

#include "haptolith/core/clock.h"
#include "haptolith/haptics/real_time.h"

namespace haptolith {

Watchdog::Watchdog(HapticDevice& device, double patience_s)
    : device_(device), patience_ns_(std::llround(patience_s * 1e9)) {}

Watchdog::~Watchdog() {
  stop();
}

void Watchdog::start() {
  stop();
  over_ = false;
  beat();
  thread_ = std::thread([this] { watch(); });
}

void Watchdog::stop() noexcept {
  if (thread_.joinable()) {
    over_ = true;
    thread_.join();
  }
}

void Watchdog::beat() noexcept {
  last_beat_ns_.store(monotonicNs(), std::memory_order_release);
}

void Watchdog::takeUp() noexcept {
  // In this order: when it barks in between, the next tick still hears of it.
  barked_.store(false, std::memory_order_release);
  device_.takeUp();
}

void Watchdog::watch() noexcept {
  (void)requestRealTime({});  // else whatever holds up the loop holds this up as well
  while (!over_.load(std::memory_order_relaxed)) {
    const std::int64_t silent_at_ns = last_beat_ns_.load(std::memory_order_acquire) + patience_ns_;
    const std::int64_t now_ns = monotonicNs();
    if (now_ns < silent_at_ns) {
      sleepUntilNs(silent_at_ns);
      continue;
    }
    if (!barked_.load(std::memory_order_acquire)) {
      // In this order: a loop that hears of it at once must not take the hand up before it has been let go.
      device_.letGo();
      barked_.store(true, std::memory_order_release);
    }
    sleepUntilNs(now_ns + patience_ns_);
  }
}

}  // namespace haptolith
