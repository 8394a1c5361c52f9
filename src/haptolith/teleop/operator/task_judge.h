#pragma once

#include <cstdint>
#include <deque>
#include <limits>

#include "haptolith/scene_file/site_task.h"
#include "haptolith/teleop/link/robot_report.h"
#include "haptolith/teleop/operator/site_map.h"

namespace haptolith {

/// Detects the completion of a task at a robot's site, at any place and by any operator: a trench once the deepest
/// place of its size, along x or y, is deep enough on the map; a press once the remote force has lasted for half a
/// second; a load once it has been carried for that time with the tool in the air. Not for the tick.
class TaskJudge {
 public:
  explicit TaskJudge(SiteTask task) : task_(task) {}

  /// Takes the current map of the site.
  void look(const SiteMap& site);
  /// Takes a report of the robot, in the order of its commands.
  void met(const RobotReport& report, double tick_s);

  [[nodiscard]] bool done() const noexcept { return done_; }
  /// Depth in m, or mean force in N over the last half second; NaN: not known yet, or the tool is not where it counts.
  [[nodiscard]] double reached() const noexcept { return reached_; }

  static constexpr double kHeld_s = 0.5;
  static constexpr double kLifted_m = 0.04;  ///< the tool above the soil's first surface, to be weighed

 private:
  struct Stretch {
    double duration_s, force_n;
  };

  SiteTask task_;
  std::uint64_t taken_ = 0;
  std::deque<Stretch> held_;  ///< the last half second in which the tool was where it counts
  double held_s_ = 0;
  bool done_ = false;
  double reached_ = std::numeric_limits<double>::quiet_NaN();
};

/// Mean depth, in m, of the deepest place as long and as wide as a trench is to be, along x or y. NaN: no place so
/// large is known.
[[nodiscard]] double deepestTrench(const HeightGrid& grid, const std::vector<double>& heights_m);

}  // namespace haptolith
