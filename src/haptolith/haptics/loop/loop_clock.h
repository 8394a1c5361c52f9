#pragma once

#include <cstdint>

#include "haptolith/bed/bed.h"
#include "haptolith/haptics/loop/deadline_miss.h"

namespace haptolith {

/// Sleeps until a tick is due. The threads that share the bed's steps are woken 150 us before: in the tick they would
/// come 50 to 100 us late, when the first of them has done much of its work alone.
void sleepUntilTick(std::int64_t due_ns, Bed& bed) noexcept;

/// When the loop's ticks are, and whether they were in time: in step with the system's clock or as fast as possible, at
/// another speed, paused. All functions but waitForTick() and waitAMoment() return at once.
class LoopClock {
 public:
  LoopClock(double tick_s, bool paced) noexcept;

  /// Begins a run: its first tick is now.
  void start() noexcept;
  /// When paced: sleeps until the tick is due, and takes note of how late it began. @return that, in us.
  double waitForTick() noexcept;
  /// As above; shortly before, wakes the threads that share the bed's steps.
  double waitForTick(Bed& bed) noexcept;
  /// A tick that is late is not made up for by a burst of early ones: the hand would feel time run faster.
  void planNextTick() noexcept;
  /// A moment, for a loop that is not paced.
  static void waitAMoment() noexcept;

  /// Work begins, and is done. @param awake  particles that were computed.
  void beginTick() noexcept;
  void endTick(std::size_t awake = 0) noexcept;
  [[nodiscard]] double tickUs() const noexcept { return tick_us_; }  ///< duration of the last tick's work
  [[nodiscard]] Miss miss() const noexcept { return miss_; }  ///< cause of the last tick's; kNone: it was in time
  [[nodiscard]] bool late() const noexcept { return late_; }  ///< a paced one's that was not in time
  [[nodiscard]] double lateUs() const noexcept { return late_us_; }  ///< lateness of the current tick's begin
  [[nodiscard]] bool paced() const noexcept { return paced_; }

  void pause() noexcept { paused_ = true; }
  void resume() noexcept;
  /// Runs a number of ticks while it is paused.
  void advance(int ticks) noexcept { ticks_left_ += paused_ ? ticks : 0; }
  /// Slow motion: a simulated second takes 1 / factor seconds.
  void setSpeed(double factor) noexcept { speed_ = factor; }
  [[nodiscard]] double speed() const noexcept { return speed_; }
  [[nodiscard]] bool paused() const noexcept { return paused_; }
  [[nodiscard]] bool standsStill() const noexcept { return paused_ && ticks_left_ == 0; }

 private:
  double wake() noexcept;

  double tick_s_;
  std::int64_t period_ns_;
  bool paced_;
  std::int64_t due_ns_ = 0;       ///< when the next tick begins
  std::int64_t deadline_ns_ = 0;  ///< deadline of the current one; 0 when not paced
  std::int64_t free_ns_ = 0;      ///< when the thread had nothing more to do before the present one
  std::int64_t begun_ns_ = 0;
  std::int64_t begun_cpu_ns_ = 0;  ///< processor time of the thread then; 0 without pacing
  double tick_us_ = 0, late_us_ = 0;
  MissClassifier misses_;
  Miss miss_ = Miss::kNone;
  bool late_ = false;
  bool paused_ = false;
  int ticks_left_ = 0;  ///< to go while paused
  double speed_ = 1;
};

}  // namespace haptolith
