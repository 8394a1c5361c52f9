#include "haptolith/teleop/operator/task_operator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "haptolith/core/interpolate.h"
#include "haptolith/core/movement.h"

namespace haptolith {

namespace {

// The trench.
constexpr double kDepth_m = SiteTaskGoals::trench_depth_m;
constexpr double kHalfLength_m = SiteTaskGoals::trench_length_m / 2, kHalfWidth_m = SiteTaskGoals::trench_width_m / 2;
constexpr double kBehind_m = -0.06, kAhead_m = 0.045;  ///< begin and end of strokes
constexpr double kDeeper_m = 0.015;                    ///< from stroke to stroke
constexpr double kBelow_m = 0.003;                     ///< the edge goes under what is wanted: some falls back in
constexpr double kDeepest_m = 0.05;
constexpr double kCarriedAbove_m = 0.05;
constexpr double kNose_rad = 70 * std::numbers::pi / 180;
constexpr double kHalfBlade_m = 0.025;  ///< from the tool's origin to its edge
constexpr double kInSoil_m_s = 0.04, kInAir_m_s = 0.15;

// The press.
constexpr double kForce_n = SiteTaskGoals::press_n, kWithin = SiteTaskGoals::press_within, kNearly = 0.97;
constexpr double kPress_m_s = 0.01, kStep_m = 0.002;
constexpr double kDeepestPress_m = -0.03;

// The scoop.
constexpr double kLoad_n = SiteTaskGoals::load_n;
constexpr double kFirstScoop_m = 0.012, kDeepestScoop_m = 0.036;
constexpr double kHeld_m = 0.05;  ///< above the soil, to be weighed
constexpr double kWeighs_s = 0.5;

constexpr double kLooks_s = 0.6;     ///< beyond the round trip, before what is seen is judged
constexpr double kCorrects_s = 0.3;  ///< in which an operator who sees the tool off its way brings it back
constexpr double kMostCorrection_m = 0.03;
constexpr std::uint64_t kSettles = 200;  ///< commands after a press that do not count

/// Orientation with the x axis tilted down by this angle.
Quat nose(double down_rad) {
  return Quat(Eigen::AngleAxisd(down_rad, Vec3::UnitY()));
}
Quat blade() {
  return nose(kNose_rad);
}

}  // namespace

TaskOperator::TaskOperator(SiteTask task, double round_trip_s, const Pose& start)
    : task_(task), round_trip_s_(round_trip_s), planned_(start), aim_n_(kForce_n) {
  if (task_ == SiteTask::kTrench) {
    stroke(kDeeper_m);
  } else if (task_ == SiteTask::kScoop) {
    scoop(kFirstScoop_m);
  } else {
    goTo({{0, 0, kCarriedAbove_m}, Quat::Identity()}, kInAir_m_s);
    goTo({{0, 0, 0.005}, Quat::Identity()}, kInAir_m_s);
  }
}

void TaskOperator::stroke(double edge_m) {
  edge_m_ = edge_m;
  ++strokes_;
  way_.clear();
  leg_ = 0;
  const double in_m = kHalfBlade_m * std::sin(kNose_rad) - edge_m;
  goTo({{kBehind_m, 0, kCarriedAbove_m}, blade()}, kInAir_m_s);
  goTo({{kBehind_m, 0, in_m}, blade()}, kInSoil_m_s);
  goTo({{kAhead_m, 0, in_m}, blade()}, kInSoil_m_s);
  goTo({{kAhead_m, 0, kCarriedAbove_m}, blade()}, kInAir_m_s);
  phase_ = Phase::kMove;
}

void TaskOperator::scoop(double depth_m) {
  constexpr double kIn_rad = 0.6, kUp_rad = -0.2;
  edge_m_ = depth_m;
  ++strokes_;
  way_.clear();
  leg_ = 0;
  if (strokes_ > 1) {
    goTo({{0, 0, kHeld_m}, nose(kNose_rad)}, kInAir_m_s);  // tips out what is too little
  }
  goTo({{-0.06, 0, 0.03}, nose(kIn_rad)}, kInAir_m_s);
  goTo({{-0.045, 0, 0.01 - depth_m}, nose(kIn_rad)}, kInSoil_m_s);
  goTo({{0.015, 0, -0.7 * depth_m}, nose(0.2)}, kInSoil_m_s);
  goTo({{0.03, 0, 0}, nose(kUp_rad)}, kInSoil_m_s);
  goTo({{0.03, 0, kHeld_m}, nose(kUp_rad)}, kInSoil_m_s);
  phase_ = Phase::kMove;
}

void TaskOperator::wait(const TaskSight& sight) {
  waits_since_s_ = sight.time_s;
  waits_at_ = sight.index;
  phase_ = Phase::kWait;
}

Pose TaskOperator::wanted(const TaskSight& sight) {
  tick_s_ = sight.time_s - last_s_;
  last_s_ = sight.time_s;
  if (phase_ == Phase::kMove && leg_ < way_.size()) {
    const Leg& leg = way_[leg_];
    const double left_m = std::max((leg.pose.position_m - planned_.position_m).norm(),
                                   0.05 * rotationBetween(planned_.orientation, leg.pose.orientation).norm());
    const double step_m = leg.speed_m_s * tick_s_;
    planned_ = left_m <= step_m ? leg.pose : interpolate(planned_, leg.pose, step_m / left_m);
    leg_ += left_m <= step_m ? 1 : 0;
  } else if (task_ == SiteTask::kTrench) {
    judgeTrench(sight);
  } else if (task_ == SiteTask::kScoop) {
    judgeScoop(sight);
  } else if (phase_ == Phase::kWait) {
    judgePress(sight);
  } else {
    press(sight);
  }
  if (task_ != SiteTask::kPress) {
    correction_m_ += tick_s_ / kCorrects_s * (planned_.position_m - sight.tool.position_m);
    correction_m_ = correction_m_.cwiseMin(kMostCorrection_m).cwiseMax(-kMostCorrection_m);
  }
  Pose wanted = planned_;
  wanted.position_m += correction_m_;
  return wanted;
}

void TaskOperator::judgeTrench(const TaskSight& sight) {
  const bool waited = phase_ == Phase::kWait;
  if (!waited) {
    wait(sight);
  }
  if (sight.own && !waited) {
    const HeightGrid& grid = sight.site->grid();
    if (!sight.site->empty() && trenchDepth(grid, sight.own(grid)) < kDepth_m && edge_m_ < kDepth_m + kBelow_m) {
      stroke(std::min(edge_m_ + kDeeper_m, kDepth_m + kBelow_m));
      return;
    }
  }
  const bool sees = !sight.site->empty();
  const double depth_m = sees ? trenchDepth(sight.site->grid(), sight.site->heights()) : 0;
  reached_ = sees ? depth_m : reached_;
  done_ = depth_m >= kDepth_m;
  if (!done_ && sight.time_s >= waits_since_s_ + round_trip_s_ + kLooks_s) {
    stroke(std::min({edge_m_ + kDeeper_m, std::max(kDepth_m + kBelow_m, edge_m_ + kDepth_m - depth_m), kDeepest_m}));
  }
}

void TaskOperator::press(const TaskSight& sight) {
  phase_ = Phase::kPress;
  const double off = 1 - sight.displayed_n / aim_n_;
  const double step_m = kPress_m_s * tick_s_ * std::clamp(off, -1.0, 1.0);
  planned_.position_m.z() = std::max(kDeepestPress_m, planned_.position_m.z() - step_m);
  pressed_m_ += std::abs(step_m);
  const bool there = std::abs(off) <= 1 - kNearly;
  if (there || (!sight.own && pressed_m_ >= kStep_m)) {
    strokes_ += there ? 1 : 0;
    pressed_m_ = 0;
    wait(sight);
  }
}

bool TaskOperator::isToBeJudged(const TaskSight& sight) const noexcept {
  return sight.time_s >= waits_since_s_ + round_trip_s_ + kLooks_s && sight.met_at >= waits_at_ + kSettles;
}

void TaskOperator::judgeScoop(const TaskSight& sight) {
  if (phase_ != Phase::kWait) {
    wait(sight);
    weighed_n_ = weighings_ = 0;
  }
  if (!isToBeJudged(sight)) {
    return;
  }
  weighed_n_ += sight.met_n;
  ++weighings_;
  if (sight.time_s >= waits_since_s_ + round_trip_s_ + kLooks_s + kWeighs_s) {
    reached_ = weighed_n_ / weighings_;
    done_ = reached_ >= kLoad_n;
    if (!done_) {
      scoop(std::min(2 * edge_m_, kDeepestScoop_m));
    }
  }
}

void TaskOperator::judgePress(const TaskSight& sight) {
  if (!isToBeJudged(sight)) {
    return;
  }
  reached_ = sight.met_n;
  done_ = std::abs(sight.met_n - kForce_n) <= kWithin * kForce_n;
  if (!done_ && sight.own) {
    aim_n_ *= std::clamp(kForce_n / std::max(sight.met_n, 0.1), 0.5, 2.0);
  }
  phase_ = Phase::kPress;
}

double trenchDepth(const HeightGrid& grid, const std::vector<double>& heights_m) {
  double sum_m = 0, count = 0;
  for (std::size_t cell = 0; cell < heights_m.size(); ++cell) {
    const std::size_t column = cell % grid.columns, row = cell / grid.columns;
    const double x_m = grid.x_m + (static_cast<double>(column) + 0.5) * grid.cell_m;
    const double y_m = grid.y_m + (static_cast<double>(row) + 0.5) * grid.cell_m;
    if (std::abs(x_m) <= kHalfLength_m && std::abs(y_m) <= kHalfWidth_m) {
      sum_m -= heights_m[cell];
      ++count;
    }
  }
  return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum_m / count;
}

}  // namespace haptolith
