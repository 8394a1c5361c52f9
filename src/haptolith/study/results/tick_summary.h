#pragma once

#include <optional>

#include "haptolith/haptics/tick_record.h"
#include "haptolith/study/store/store.h"

namespace haptolith {

/// Accumulates movement of a hand and force on it, tick by tick.
class TickSummary {
 public:
  void add(const TickRecord& tick) noexcept;
  /// Returns the summary; values without data are NaN.
  [[nodiscard]] TrialSummary summary() const noexcept;

 private:
  std::optional<TickRecord> last_;
  int ticks_ = 0, steps_ = 0, misses_ = 0;
  double first_s_ = 0, path_m_ = 0, peak_speed_m_s_ = 0, work_j_ = 0;
  double peak_force_n_ = 0, sum_n_ = 0, sum_of_squares_n2_ = 0, peak_torque_nm_ = 0;
};

}  // namespace haptolith
