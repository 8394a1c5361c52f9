#include "haptolith/ros2/target_device.h"

#include <cmath>
#include <utility>

#include "haptolith/core/platform/clock.h"

namespace haptolith {

TargetDevice::TargetDevice(std::shared_ptr<TargetInbox> inbox, const TargetParameters& parameters,
                           const HandParameters& hand, double tick_s)
    : inbox_(std::move(inbox)),
      parameters_(parameters),
      hand_(hand, tick_s),
      fresh_ns_(std::llround(1e9 * requireInRange("fresh_s", parameters.fresh_s, TargetParameters::kFresh_s))) {
  input_.state = DeviceState::kStale;
}

DeviceLimits TargetDevice::limits() const noexcept {
  DeviceLimits limits = hand_.limits();
  limits.damping_n_s_m = VirtualHand::kPull.damping_n_s_m;
  limits.grips = false;  // a pose says nothing of jaws
  return limits;
}

DeviceInput TargetDevice::read() noexcept {
  inbox_->update();
  const ToolTarget& target = inbox_->latest();
  if (target.came_ns == 0 || monotonicNs() - target.came_ns > fresh_ns_) {
    input_.state = DeviceState::kStale;
    input_.twist = {};
    return input_;
  }
  if (target.came_ns != taken_ns_) {
    taken_ns_ = target.came_ns;
    Pose held = target.scene_T_tool;
    held.position_m = held.position_m.cwiseMax(parameters_.low_m).cwiseMin(parameters_.high_m);
    HandCommand command;
    command.held = held;
    hand_.command(command);
  }
  input_ = hand_.read();
  return input_;
}

}  // namespace haptolith
