#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/core/vec.h"
#include "haptolith/scene_file/site_task.h"
#include "haptolith/teleop/operator/site_map.h"

namespace haptolith {

/// Information for an operator.
struct TaskSight {
  double time_s = 0;
  std::uint64_t index = 0;   ///< index of the tick
  Pose tool;                 ///< in the operator's hand, site frame
  double displayed_n = 0;    ///< size of the force
  double met_n = 0;          ///< size of the force that the robot met at the newest command that was heard of
  std::uint64_t met_at = 0;  ///< that command
  const SiteMap* site = nullptr;
  /// Heights of the soil in the operator's own model; empty: no model.
  std::function<std::vector<double>(const HeightGrid& grid)> own = {};
};

/// A virtual operator with a task, in the site frame (z is 0 at the soil's first surface), which continues until the
/// task is seen complete at the robot's site. With a model of the soil it plans strokes by that and checks the site
/// at the end; without one it moves, waits for the result to be visible, and moves again (move and wait). Not for
/// the tick.
class TaskOperator {
 public:
  /// @param round_trip_s  as the operator knows it.
  TaskOperator(SiteTask task, double round_trip_s, const Pose& start);

  /// Pose that the hand aims at now, site frame; call it once a tick.
  [[nodiscard]] Pose wanted(const TaskSight& sight);

  [[nodiscard]] bool done() const noexcept { return done_; }
  /// Strokes of the trench, presses, or scoops.
  [[nodiscard]] int strokes() const noexcept { return strokes_; }
  /// Depth of the trench in m, or force or weight in N: as it was seen at the site when last judged.
  [[nodiscard]] double reached() const noexcept { return reached_; }

 private:
  enum class Phase : std::uint8_t { kMove, kPress, kWait };
  void judgeTrench(const TaskSight& sight);
  void press(const TaskSight& sight);
  void judgePress(const TaskSight& sight);
  void judgeScoop(const TaskSight& sight);
  [[nodiscard]] bool isToBeJudged(const TaskSight& sight) const noexcept;
  void stroke(double edge_m);
  void scoop(double depth_m);
  void goTo(const Pose& pose, double speed_m_s) { way_.push_back({pose, speed_m_s}); }
  void wait(const TaskSight& sight);

  struct Leg {
    Pose pose;
    double speed_m_s;
  };

  SiteTask task_;
  double round_trip_s_;
  Phase phase_ = Phase::kMove;
  std::vector<Leg> way_;
  std::size_t leg_ = 0;
  Pose planned_;
  Vec3 correction_m_ = Vec3::Zero();
  double last_s_ = 0, tick_s_ = 0, waits_since_s_ = 0;
  std::uint64_t waits_at_ = 0;
  double edge_m_ = 0;     ///< last depth of the blade's edge, or of the scoop
  double aim_n_ = 0;      ///< target force
  double pressed_m_ = 0;  ///< since the last wait
  double weighed_n_ = 0, weighings_ = 0;
  bool done_ = false;
  int strokes_ = 0;
  double reached_ = 0;
};

/// Mean depth of a trench in m: of the cells along its middle, under the surface. NaN where one is not known.
[[nodiscard]] double trenchDepth(const HeightGrid& grid, const std::vector<double>& heights_m);

}  // namespace haptolith
