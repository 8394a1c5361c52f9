#pragma once

#include <atomic>
#include <thread>

#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/haptics/real_time.h"

namespace haptolith {

/// The loop's thread: on the CPU that the parameters name, and real-time when they ask for it and the system grants it.
/// The force is released when it ends, and when this object is destroyed.
class LoopThread {
 public:
  /// @param stop  ends the loop when it becomes true; set by the destructor.
  /// @throws InvalidParameter as requireUsableCpu(), Failure when the system grants no thread; then none has been
  /// started.
  LoopThread(HapticLoop& loop, const LoopParameters& parameters, std::atomic<bool>& stop);
  ~LoopThread();
  LoopThread(const LoopThread&) = delete;
  LoopThread& operator=(const LoopThread&) = delete;

  [[nodiscard]] bool done() const noexcept { return done_.load(std::memory_order_acquire); }

  /// Waits the moment until it is known.
  [[nodiscard]] const RealTime& realTime() const;

  /// Waits for the loop's end.
  LoopEnd join();

 private:
  std::atomic<bool>& stop_;
  std::atomic<bool> done_{false}, real_time_known_{false};
  RealTime real_time_;
  LoopEnd end_ = LoopEnd::kRunning;
  std::thread thread_;
};

}  // namespace haptolith
