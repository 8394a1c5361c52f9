#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Releases the force when the loop falls silent: from a separate thread, because the loop cannot. If the
/// complete process was suspended, the loop may be the first to wake; so the loop itself also checks how long it was
/// silent. One for a loop; it sleeps until start().
class Watchdog {
 public:
  /// @param timeout_s  longest silence that is tolerated.
  /// @throws Failure when the system grants no thread.
  Watchdog(HapticDevice& device, double timeout_s);
  ~Watchdog();
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  /// Begins and ends to watch: before the first tick and after the last. Once stop() has returned, it no longer touches
  /// the device.
  void start() noexcept;
  void stop() noexcept;

  /// The loop lives. Whether it has been silent for too long before, no matter who noticed. May be called in the tick.
  [[nodiscard]] bool beat() noexcept;

  /// Whether a force that was computed since the last beat() must not be rendered any more: the watchdog has tripped
  /// since the last resumeForce(), or should have been. May be called in the tick.
  [[nodiscard]] bool tooLate() const noexcept;

  /// Whether this thread has released the force since the last resumeForce(). May be called in the tick.
  [[nodiscard]] bool fired() const noexcept { return fired_.load(std::memory_order_acquire); }

  /// The loop lives again, and gives the hand force again. In the tick.
  void resumeForce() noexcept;

 private:
  /// kIdle: no loop is watched, and the thread has noticed. kStopping: the thread has yet to notice.
  enum class State : std::uint8_t { kIdle, kWatching, kStopping, kOver };

  [[nodiscard]] bool watches() const noexcept { return state_.load(std::memory_order_relaxed) == State::kWatching; }
  void live() noexcept;
  void watch() noexcept;

  HapticDevice& device_;
  std::int64_t timeout_ns_;
  std::atomic<std::int64_t> last_beat_ns_{0};
  std::atomic<bool> fired_{false};
  std::atomic<State> state_{State::kIdle};
  std::thread thread_;
};

}  // namespace haptolith
