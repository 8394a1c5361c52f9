#include "haptolith/haptics/safety/watchdog.h"

#include <cmath>

#include "haptolith/core/platform/clock.h"
#include "haptolith/core/platform/sleep_while.h"
#include "haptolith/core/platform/start_thread.h"
#include "haptolith/haptics/real_time.h"

namespace haptolith {

Watchdog::Watchdog(HapticDevice& device, double timeout_s)
    : device_(device),
      timeout_ns_(std::llround(timeout_s * 1e9)),
      thread_(startThread("the safety watchdog", [this] { live(); })) {}

Watchdog::~Watchdog() {
  stop();
  state_ = State::kOver;
  wakeAll(state_);
  thread_.join();
}

void Watchdog::start() noexcept {
  stop();
  last_beat_ns_ = monotonicNs();
  state_ = State::kWatching;
  wakeAll(state_);
}

void Watchdog::stop() noexcept {
  if (state_ == State::kWatching) {
    state_ = State::kStopping;
    sleepWhile(state_, State::kStopping);
  }
}

bool Watchdog::beat() noexcept {
  const std::int64_t now_ns = monotonicNs();
  const std::int64_t silent_ns = now_ns - last_beat_ns_.exchange(now_ns, std::memory_order_acq_rel);
  return fired() || (watches() && silent_ns > timeout_ns_);
}

bool Watchdog::tooLate() const noexcept {
  const std::int64_t silent_ns = monotonicNs() - last_beat_ns_.load(std::memory_order_relaxed);
  return fired() || (watches() && silent_ns > timeout_ns_);
}

void Watchdog::resumeForce() noexcept {
  // In this order: when it barks in between, the next tick still hears of it.
  fired_.store(false, std::memory_order_release);
  device_.resumeForce();
}

void Watchdog::live() noexcept {
  (void)requestRealTime({});  // else whatever holds up the loop holds this up as well
  while (true) {
    sleepWhile(state_, State::kIdle);
    if (state_ == State::kOver) {
      return;
    }
    watch();
    state_ = State::kIdle;
    wakeAll(state_);
  }
}

void Watchdog::watch() noexcept {
  while (state_.load(std::memory_order_relaxed) == State::kWatching) {
    const std::int64_t silent_at_ns = last_beat_ns_.load(std::memory_order_acquire) + timeout_ns_;
    const std::int64_t now_ns = monotonicNs();
    if (now_ns < silent_at_ns) {
      sleepUntilNs(silent_at_ns);
      continue;
    }
    if (!fired_.load(std::memory_order_acquire)) {
      // In this order: a loop that is notified must not resume the force before it has been released.
      device_.releaseForce();
      fired_.store(true, std::memory_order_release);
    }
    sleepUntilNs(now_ns + timeout_ns_);
  }
}

}  // namespace haptolith
