#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Lets go of the hand when the loop falls silent: from a thread of its own, since the loop cannot. One for a loop; it
/// sleeps until start().
class Watchdog {
 public:
  /// @param patience_s  the longest silence that is borne.
  Watchdog(HapticDevice& device, double patience_s);
  ~Watchdog();
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  /// Begins and ends to watch. start() and stop() wait and lock: before the first tick and after the last.
  void start();
  void stop() noexcept;

  /// The loop lives. May be called in the tick.
  void beat() noexcept;

  /// Whether the hand has been let go since the last takeUp(). May be called in the tick.
  [[nodiscard]] bool barked() const noexcept { return barked_.load(std::memory_order_acquire); }

  /// The loop lives again, and gives the hand force again. In the tick.
  void takeUp() noexcept;

 private:
  void watch() noexcept;

  HapticDevice& device_;
  std::int64_t patience_ns_;
  std::atomic<std::int64_t> last_beat_ns_{0};
  std::atomic<bool> barked_{false}, over_{false};
  std::thread thread_;
};

}  // namespace haptolith
