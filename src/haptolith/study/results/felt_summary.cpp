#include "haptolith/study/results/felt_summary.h"

#include <algorithm>
#include <cmath>

namespace haptolith {

void FeltSummary::add(const TickRecord& tick) noexcept {
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

TrialSummary FeltSummary::summary() const noexcept {
  TrialSummary felt;
  felt.deadline_misses = misses_;
  if (ticks_ == 0) {
    return felt;
  }
  felt.duration_s = last_->time_s - first_s_;
  felt.path_m = path_m_;
  if (steps_ > 0) {
    felt.peak_speed_m_s = peak_speed_m_s_;
    felt.mean_speed_m_s = path_m_ / felt.duration_s;
  }
  felt.peak_force_n = peak_force_n_;
  felt.mean_force_n = sum_n_ / ticks_;
  felt.force_sd_n = std::sqrt(std::max(0.0, sum_of_squares_n2_ / ticks_ - felt.mean_force_n * felt.mean_force_n));
  felt.peak_torque_nm = peak_torque_nm_;
  felt.work_j = work_j_;
  return felt;
}

}  // namespace haptolith
