#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "haptolith/teleop/operator/site_map.h"

namespace haptolith::simulation {

/// Accuracy of an operator's map of a site's surface in the dug area: in cells whose height has
/// changed by more than a millimetre, each once it has been at rest for a while. Inside this folder alone.
class SurfaceWatch {
 public:
  /// @param late_s  how long a cell has to have been at rest.
  explicit SurfaceWatch(double late_s) : late_s_(late_s) {}

  /// When the camera has looked. @param heights_m  as they are, over the site's zero. @param known  on the same grid.
  void look(double now_s, const std::vector<double>& heights_m, const SiteMap& known) {
    if (first_m_.empty()) {
      first_m_ = rested_at_m_ = heights_m;
      since_s_.assign(heights_m.size(), now_s);
    }
    now_m_ = heights_m;
    for (std::size_t cell = 0; cell < heights_m.size(); ++cell) {
      if (std::abs(heights_m[cell] - rested_at_m_[cell]) > kAtRest_m) {
        rested_at_m_[cell] = heights_m[cell];
        since_s_[cell] = now_s;
      }
      if (isDug(cell) && now_s >= since_s_[cell] + late_s_) {
        known_.add(known.empty() ? heights_m[cell] : known.heights()[cell] - heights_m[cell]);
      }
    }
  }
  /// The site, and another surface on the same grid, at the same command.
  void compare(const std::vector<double>& heights_m, const std::vector<double>& others_m) {
    apart_ = {};
    for (std::size_t cell = 0; cell < now_m_.size(); ++cell) {
      if (isDug(cell)) {
        apart_.add(others_m[cell] - heights_m[cell]);
      }
    }
  }
  /// RMS of what is known less what is, over all looks; 0: nothing was dug.
  [[nodiscard]] double known() const noexcept { return known_.rms(); }
  /// RMS of the other surface less this one, where this was dug, at the last comparison.
  [[nodiscard]] double apart() const noexcept { return apart_.rms(); }

 private:
  static constexpr double kDug_m = 1e-3, kAtRest_m = 3e-4;
  struct SquareMean {
    double sum = 0, count = 0;
    void add(double value) noexcept {
      sum += value * value;
      ++count;
    }
    [[nodiscard]] double rms() const noexcept { return count == 0 ? 0 : std::sqrt(sum / count); }
  };
  [[nodiscard]] bool isDug(std::size_t cell) const noexcept { return std::abs(now_m_[cell] - first_m_[cell]) > kDug_m; }

  double late_s_;
  std::vector<double> first_m_, now_m_, rested_at_m_, since_s_;
  SquareMean known_, apart_;
};

}  // namespace haptolith::simulation
