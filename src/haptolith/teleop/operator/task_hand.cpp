#include "haptolith/teleop/operator/task_hand.h"

namespace haptolith {

TaskHand::TaskHand(const std::optional<ArmParameters>& arm, const DeviceLimits& limits, double tick_s,
                   const Pose& start)
    : arm_(arm), limits_(limits), tick_s_(tick_s), wanted_(start), next_(start), tool_{start, {}} {}

void TaskHand::releaseTool(const Movement& tool) noexcept {
  constexpr ArmParameters kHandle{.mass_kg = 0.3, .damping_n_s_m = 2, .stiffness_n_m = 0, .lever_m = 0.1};
  arm_ = kHandle;
  tool_ = tool;
  wanted_ = next_ = tool.pose;
}

DeviceInput TaskHand::read() noexcept {
  const Movement wanted = movement(wanted_, next_, tick_s_);
  wanted_ = next_;
  if (arm_) {
    (void)moveArm(*arm_, wanted, displayed_, DeviceLimits::kNone, tick_s_, tool_);
  } else {
    tool_ = wanted;
  }
  DeviceInput input;
  input.pose = tool_.pose;
  input.twist = tool_.twist;
  input.gripper_open = 1;
  return input;
}

}  // namespace haptolith
