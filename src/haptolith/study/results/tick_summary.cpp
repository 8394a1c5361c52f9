#include "haptolith/study/results/tick_summary.h"

#include <algorithm>
#include <cmath>

namespace haptolith {

void TickSummary::add(const TickRecord& tick) noexcept {
  const double force_n = tick.sent.wrench.force_n.norm();
  ++ticks_;
  sum_n_ += force_n;
  sum_of_squares_n2_ += force_n * force_n;
  peak_force_n_ = std::max(peak_force_n_, force_n);
  peak_torque_nm_ = std::max(peak_torque_nm_, tick.sent.wrench.torque_nm.norm());
  misses_ += (tick.flags & kTickLate) != 0 ? 1 : 0;
  if (!last_) {
    first_s_ = tick.time_s;
  } else if (const double elapsed_s = tick.time_s - last_->time_s; elapsed_s > 0) {
    const Vec3 step_m = tick.scene_T_tool.position_m - last_->scene_T_tool.position_m;
    ++steps_;
    path_m_ += step_m.norm();
    peak_speed_m_s_ = std::max(peak_speed_m_s_, step_m.norm() / elapsed_s);
    work_j_ -= 0.5 * (tick.soil.force_n + last_->soil.force_n).dot(step_m);
  }
  last_ = tick;
}

TrialSummary TickSummary::summary() const noexcept {
  TrialSummary summary;
  summary.deadline_misses = misses_;
  if (ticks_ == 0) {
    return summary;
  }
  summary.duration_s = last_->time_s - first_s_;
  summary.path_m = path_m_;
  if (steps_ > 0) {
    summary.peak_speed_m_s = peak_speed_m_s_;
    summary.mean_speed_m_s = path_m_ / summary.duration_s;
  }
  summary.peak_force_n = peak_force_n_;
  summary.mean_force_n = sum_n_ / ticks_;
  summary.force_sd_n =
      std::sqrt(std::max(0.0, sum_of_squares_n2_ / ticks_ - summary.mean_force_n * summary.mean_force_n));
  summary.peak_torque_nm = peak_torque_nm_;
  summary.work_j = work_j_;
  return summary;
}

}  // namespace haptolith
