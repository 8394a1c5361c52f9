#pragma once

#include <cstdint>

namespace haptolith {

/// Share of a tick's period that waking up may take; the rest is for its work.
inline constexpr double kWakeUpShare = 0.2;

/// Ratio to the usual duration above which a tick counts as interrupted, while the soil is unchanged.
inline constexpr double kUnusual = 3;

/// Cause of a missed deadline.
enum class Miss : std::uint8_t {
  kNone,       ///< the tick was in time
  kTooLong,    ///< its own work: soil too fine for this machine, or a device that always keeps the loop waiting
  kWokenLate,  ///< the machine woke the loop's thread late
  kPreempted,  ///< the processor was taken away during the tick: by other threads, or by the host of a virtual machine
};
inline constexpr int kMissCauses = 4;

/// Times of one tick, in us.
struct TickTiming {
  double period_us = 1000;  ///< from when the tick is due to its deadline
  double late_us = 0;       ///< from when it was due to its beginning
  double busy_us = 0;       ///< part of late_us in which the tick before still ran
  double wall_us = 0;       ///< from its beginning to its end
  double cpu_us = 0;        ///< processor time of its thread meanwhile; wall_us where it is not known
};

/// Cause of the miss of a tick that ended after its deadline.
///
/// A tick has a fifth of its period to wake up and four fifths to work. The cause is the part that exceeded its share
/// by most: waking up, work, or time in which the processor was taken away (share: none). Two kinds of time count as
/// taken away:
///   - Time in which the thread did not run, as far as the tick took longer than usual. A device that blocks in every
///     tick is usual, and part of the work.
///   - All time beyond the usual, where the processor time alone is kUnusual times the usual. The host of a virtual
///     machine can take the processor without a trace in the guest's clocks, and an interrupted helper thread keeps the
///     loop's thread spinning.
/// A tick that was late only because the tick before had not ended inherits that tick's cause. The exception is a tick
/// whose own work exceeds its share: it leaves no room to catch up, and the soil is the cause.
///
/// The times cannot show everything. Soil that takes kUnusual times as long for one tick with as many particles awake
/// counts as kPreempted, and so does a device that blocks now and then. An interruption shorter than the usual
/// variation of a tick counts as kTooLong in a tick that was nearly too long anyway.
/// @param usual_us  what a tick of this soil usually takes.
/// @param before    cause of the tick before.
[[nodiscard]] Miss causeOfMiss(const TickTiming& tick, double usual_us, Miss before) noexcept;

/// Classifies the ticks of a loop one after the other. May be called in the tick.
class MissClassifier {
 public:
  /// Cause of the miss of the next tick, kNone when it was in time.
  /// @param awake  particles that were computed in it: a tick usually takes as long as there are many.
  Miss classify(const TickTiming& tick, bool missed, double awake) noexcept;

 private:
  double usual_us_ = 0;  ///< running median of a tick's time by its load; 0 before the first tick
  Miss before_ = Miss::kNone;
};

}  // namespace haptolith
