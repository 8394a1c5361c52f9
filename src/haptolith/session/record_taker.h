#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/session/session_recording.h"

namespace haptolith {

/// Moves the loop's records into the recording, and hands on those of the first tool, on a separate thread: nothing is
/// lost while the thread that follows the loop is blocked, by viewers or by an unread terminal.
class RecordTaker {
 public:
  enum class Keep { kNothing, kForTake };
  /// Receives each tick soon after it, on one thread at a time; must not wait.
  using Listener = std::function<void(std::span<const TickRecord>)>;

  /// @param keep   whether take() is called by a user of the ticks.
  /// @param real_time  else the loop waits when too many ticks wait for take(); in real time they are lost to it (to it
  ///                   alone, the recording has them).
  RecordTaker(HapticLoop& loop, SessionRecording& recording, Keep keep, bool real_time, Listener listener = {});
  ~RecordTaker();
  RecordTaker(const RecordTaker&) = delete;
  RecordTaker& operator=(const RecordTaker&) = delete;

  /// For the thread that follows the loop: takes at once what there is, and moves all since the last call to the end of
  /// `ticks`, unless nothing is kept.
  void take(std::vector<TickRecord>& ticks);

  /// Ticks that take() has missed. The recording counts its own.
  [[nodiscard]] std::uint64_t lost() const;

 private:
  void takeNow();  // with the lock held

  HapticLoop& loop_;
  SessionRecording& recording_;
  const bool keeps_, real_time_;
  const Listener listener_;
  mutable std::mutex mutex_;
  std::vector<TickRecord> fresh_, kept_;
  std::uint64_t not_kept_ = 0;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace haptolith
