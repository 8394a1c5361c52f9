#include "haptolith/device/mapping.h"

#include "haptolith/core/error.h"
#include "haptolith/core/turn.h"

namespace haptolith {

namespace {
/// Duration of the force's return after the clutch.
constexpr double kClutchFade_s = 0.2;

}  // namespace

void validate(const MappingParameters& mapping) {
  for (const double axis : mapping.offset_m) {
    requireInRange("offset_m", axis, MappingRanges::offset_m);
  }
  for (const double angle : mapping.turn_rad) {
    requireInRange("turn_rad", angle, MappingRanges::turn_rad);
  }
  requireInRange("scale", mapping.scale, MappingRanges::scale);
  requireInRange("force_scale", mapping.force_scale, MappingRanges::force_scale);
  requireInRange("clutch_button", mapping.clutch_button, MappingRanges::clutch_button);
}

Mapping::Mapping(const MappingParameters& parameters, const DeviceLimits& device, double tick_s)
    : mapping_(parameters),
      turn_(turnAboutXyz(parameters.turn_rad) * turnAboutXyz(device.turn_rad)),
      anchor_device_m_(device.workspace_centre_m),
      anchor_scene_m_(parameters.offset_m),
      tick_s_(tick_s) {
  validate(parameters);
  mapping_.gripper = parameters.gripper && device.grips;
}

HandState Mapping::toScene(const DeviceInput& input) noexcept {
  const Quat turned = turn_ * input.pose.orientation * turn_.conjugate();
  const bool was_clutched = clutched_;
  clutched_ = mapping_.clutch_button >= 0 && (input.buttons >> mapping_.clutch_button & 1U) != 0;
  const double opening = mapping_.gripper ? input.gripper_open : 1;
  if (clutched_) {
    clutch_.set(0);
  } else {
    clutch_.rise(tick_s_, kClutchFade_s);
  }
  if (clutched_ && known_) {
    return {{tool_, {}}, opening};
  }
  known_ = true;
  if (was_clutched) {  // the tool is where it was, the hand somewhere else
    anchor_device_m_ = input.pose.position_m;
    anchor_scene_m_ = tool_.position_m;
    anchor_turn_ = (turned.conjugate() * tool_.orientation).normalized();
  }
  tool_.position_m = anchor_scene_m_ + mapping_.scale * (turn_ * (input.pose.position_m - anchor_device_m_));
  tool_.orientation = turned * anchor_turn_;
  return {{tool_, {mapping_.scale * (turn_ * input.twist.linear_m_s), turn_ * input.twist.angular_rad_s}}, opening};
}

DeviceOutput Mapping::toDevice(const ToolForce& scene) const noexcept {
  const Quat back = turn_.conjugate();
  const double share = clutch_.share() * mapping_.force_scale;
  return {{share * (back * scene.wrench.force_n), share / mapping_.scale * (back * scene.wrench.torque_nm)},
          mapping_.gripper ? share * scene.grip_n : 0};
}

Wrench Mapping::turnedIntoScene(const Wrench& device) const noexcept {
  return {turn_ * device.force_n, turn_ * device.torque_nm};
}

}  // namespace haptolith
