#include "haptolith/teleop/operator/task_judge.h"

#include <algorithm>
#include <cmath>

namespace haptolith {

namespace {

/// Sums over rectangles of a map, each of four reads; one with a hole in it is NaN.
class RectangleSums {
 public:
  RectangleSums(const HeightGrid& grid, const std::vector<double>& heights_m)
      : width_(grid.columns + 1), sums_(width_ * (grid.rows + 1), 0), holes_(sums_.size(), 0) {
    for (std::size_t row = 0; row < grid.rows; ++row) {
      for (std::size_t column = 0; column < grid.columns; ++column) {
        const double height_m = heights_m[row * grid.columns + column];
        const bool hole = std::isnan(height_m);
        add(sums_, column, row, hole ? 0 : height_m);
        add(holes_, column, row, hole ? 1 : 0);
      }
    }
  }

  [[nodiscard]] double mean(std::size_t column, std::size_t row, std::size_t columns, std::size_t rows) const {
    return sum(holes_, column, row, columns, rows) > 0
               ? std::numeric_limits<double>::quiet_NaN()
               : sum(sums_, column, row, columns, rows) / static_cast<double>(columns * rows);
  }

 private:
  using Table = std::vector<double>;  ///< sums over all cells before a corner

  void add(Table& table, std::size_t column, std::size_t row, double value) const {
    const std::size_t at = row * width_ + column;
    table[at + width_ + 1] = value + table[at + width_] + table[at + 1] - table[at];
  }
  [[nodiscard]] double sum(const Table& table, std::size_t column, std::size_t row, std::size_t columns,
                           std::size_t rows) const {
    const std::size_t low = row * width_ + column, high = low + rows * width_;
    return table[high + columns] - table[high] - table[low + columns] + table[low];
  }

  std::size_t width_;
  Table sums_, holes_;
};

}  // namespace

double deepestTrench(const HeightGrid& grid, const std::vector<double>& heights_m) {
  const auto cells = [&](double length_m) {
    return std::max<std::size_t>(1, static_cast<std::size_t>(std::llround(length_m / grid.cell_m)));
  };
  const std::size_t length = cells(SiteTaskGoals::trench_length_m), width = cells(SiteTaskGoals::trench_width_m);
  const RectangleSums sums(grid, heights_m);
  double deepest_m = std::numeric_limits<double>::quiet_NaN();
  const auto look = [&](std::size_t columns, std::size_t rows) {
    for (std::size_t row = 0; row + rows <= grid.rows; ++row) {
      for (std::size_t column = 0; column + columns <= grid.columns; ++column) {
        deepest_m = std::fmax(deepest_m, -sums.mean(column, row, columns, rows));  // a NaN counts for nothing
      }
    }
  };
  look(length, width);
  look(width, length);
  return deepest_m;
}

void TaskJudge::look(const SiteMap& site) {
  if (task_ != SiteTask::kTrench || site.empty() || site.taken() == taken_) {
    return;
  }
  taken_ = site.taken();
  reached_ = deepestTrench(site.grid(), site.heights());
  done_ = done_ || reached_ >= SiteTaskGoals::trench_depth_m;
}

void TaskJudge::met(const RobotReport& report, double tick_s) {
  if (task_ == SiteTask::kTrench || report.ticks == 0) {
    return;
  }
  if (task_ == SiteTask::kScoop && report.pose.position_m.z() < kLifted_m) {
    held_.clear();
    held_s_ = 0;
    reached_ = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  held_.push_back({report.ticks * tick_s, report.met.force_n.norm()});
  held_s_ += held_.back().duration_s;
  while (held_s_ - held_.front().duration_s >= kHeld_s) {
    held_s_ -= held_.front().duration_s;
    held_.pop_front();
  }
  double sum_ns = 0;
  bool within = true;
  for (const Stretch& stretch : held_) {
    sum_ns += stretch.force_n * stretch.duration_s;
    within = within &&
             std::abs(stretch.force_n - SiteTaskGoals::press_n) <= SiteTaskGoals::press_within * SiteTaskGoals::press_n;
  }
  reached_ = sum_ns / held_s_;
  const bool is_reached = task_ == SiteTask::kPress ? within : reached_ >= SiteTaskGoals::load_n;
  done_ = done_ || (held_s_ >= kHeld_s && is_reached);
}

}  // namespace haptolith
