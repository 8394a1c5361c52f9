#pragma once

#include <array>
#include <bitset>
#include <cstdint>

#include "haptolith/core/histogram.h"
#include "haptolith/core/vec.h"
#include "haptolith/haptics/loop/deadline_miss.h"

namespace haptolith {

/// Statistics of the loop. Fixed memory; add() may be called in the tick.
class LoopStatistics {
 public:
  /// One tick: how long its work took, why it missed its deadline, and what the hand was made to feel.
  void add(double tick_us, Miss miss, const Wrench& felt) noexcept;

  /// Adds the lateness of the begin of a tick in real time: the system woke its thread late, or the tick before took
  /// too long.
  void addLateness(double late_us) noexcept { late_us_.add(late_us); }

  [[nodiscard]] std::uint64_t ticks() const noexcept { return tick_us_.count(); }
  [[nodiscard]] std::uint64_t deadlineMisses() const noexcept { return ticks() - misses(Miss::kNone); }
  /// Ticks that missed their deadline for one cause; of kNone those in time.
  [[nodiscard]] std::uint64_t misses(Miss cause) const noexcept { return by_cause_[static_cast<std::size_t>(cause)]; }

  /// Share of the last 100 ticks that ended in time; of all ticks while there are fewer; 1 before the first.
  [[nodiscard]] double successRate() const noexcept;

  [[nodiscard]] const Histogram& tickUs() const noexcept { return tick_us_; }
  /// Empty when no tick was in real time.
  [[nodiscard]] const Histogram& lateUs() const noexcept { return late_us_; }
  [[nodiscard]] const Histogram& forceN() const noexcept { return force_n_; }
  [[nodiscard]] const Histogram& torqueNm() const noexcept { return torque_nm_; }

 private:
  static constexpr std::size_t kWindow = 100;

  Histogram tick_us_{0.1}, late_us_{0.1}, force_n_{1e-6}, torque_nm_{1e-8};
  std::array<std::uint64_t, kMissCauses> by_cause_{};
  std::bitset<kWindow> missed_lately_;
};

}  // namespace haptolith
