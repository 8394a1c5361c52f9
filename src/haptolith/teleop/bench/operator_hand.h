#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/teleop/bench/simulation.h"
#include "haptolith/teleop/operator/task_hand.h"
#include "haptolith/teleop/operator/task_operator.h"

namespace haptolith::simulation {

/// The hand of a scene, above a surface.
inline HandParameters handAbove(const SceneFile& scene_file, double surface_m) {
  HandParameters hand = scene_file.hand;
  hand.surface_m = surface_m;
  return hand;
}

/// Mover of the tool in a simulation: the hand of the scene, until it releases, or one with a task. Inside this folder
/// alone.
class OperatorHand final : public HapticDevice {
 public:
  /// @param surface_m  height of the soil in the hand's frame.
  OperatorHand(const TeleopSetup& setup, double surface_m)
      : surface_m_(surface_m),
        tick_s_(setup.model.loop.tick_s),
        release_s_(setup.release_s),
        scene_hand_(handAbove(setup.model, surface_m), tick_s_) {
    last_.pose = VirtualHand(handAbove(setup.model, surface_m), tick_s_).read().pose;
    if (setup.task) {
      const HandParameters& hand = setup.model.hand;
      const bool yields = hand.compliance == HandCompliance::kArm;
      Pose start = last_.pose;
      task_hand_.emplace(yields ? std::optional(armOf(hand)) : std::nullopt, scene_hand_.limits(), tick_s_, start);
      start.position_m.z() -= surface_m;
      task_.emplace(*setup.task, setup.up.delay_s + setup.down.delay_s, start);
      tool_ = start;
    }
  }

  [[nodiscard]] std::string_view name() const noexcept override { return scene_hand_.name(); }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return scene_hand_.limits(); }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] DeviceInput read() noexcept override {
    const bool ends = task_hand_ == std::nullopt && release_s_ && static_cast<double>(ticks_) * tick_s_ >= *release_s_;
    if (ends) {
      task_hand_.emplace(std::nullopt, scene_hand_.limits(), tick_s_, last_.pose);
      task_hand_->releaseTool({last_.pose, last_.twist});
    }
    ++ticks_;
    return last_ = task_hand_ ? task_hand_->read() : scene_hand_.read();
  }
  void write(const DeviceOutput& output) noexcept override {
    task_hand_ ? task_hand_->write(output) : scene_hand_.write(output);
  }
  void releaseForce() noexcept override { scene_hand_.releaseForce(); }
  void resumeForce() noexcept override { scene_hand_.resumeForce(); }
  /// Whether a hand holds the tool.
  [[nodiscard]] bool holds() const noexcept { return task_ || !task_hand_; }
  [[nodiscard]] bool hasTask() const noexcept { return task_.has_value(); }
  /// Before a tick, where it has a task; the tool is where it was last said to have come to.
  void look(TaskSight sight) {
    sight.tool = tool_;
    Pose wanted = task_->wanted(sight);
    wanted.position_m.z() += surface_m_;
    task_hand_->want(wanted);
    done_s_ = task_->done() && std::isnan(done_s_) ? sight.time_s : done_s_;
  }
  /// After a tick, site frame.
  void came(const Pose& tool) noexcept { tool_ = tool; }
  [[nodiscard]] bool done() const noexcept { return task_ && task_->done(); }
  [[nodiscard]] std::optional<TaskResult> result() const {
    return task_ ? std::optional(TaskResult{done_s_, task_->strokes(), task_->reached()}) : std::nullopt;
  }

 private:
  double surface_m_, tick_s_;
  std::optional<double> release_s_;
  VirtualHand scene_hand_;
  std::optional<TaskHand> task_hand_;
  std::optional<TaskOperator> task_;
  Pose tool_;
  DeviceInput last_;
  std::uint64_t ticks_ = 0;
  double done_s_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace haptolith::simulation
