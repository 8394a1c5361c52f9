#include "haptolith/library/ticks.h"

#include "haptolith/library/values.h"

namespace haptolith::library {

hapto_tick tickOf(const TickRecord& record) noexcept {
  return {.size = sizeof(hapto_tick),
          .flags = record.flags,
          .trip = record.trip,
          .buttons = record.device.buttons,
          .device_state = static_cast<std::int32_t>(record.device.state),
          .reserved = 0,
          .time_s = record.time_s,
          .device_pose = pose(record.device.pose),
          .device_twist = twist(record.device.twist),
          .gripper_open = record.device.gripper_open,
          .scene_T_tool = pose(record.scene_T_tool),
          .soil = wrench(record.soil),
          .rendered = wrench(record.rendered.wrench),
          .rendered_gripper_n = record.rendered.gripper_force_n,
          .felt = wrench(record.felt.wrench),
          .felt_gripper_n = record.felt.gripper_force_n,
          .injected_j = record.injected_j,
          .quick_injected_j = record.quick_injected_j,
          .tick_us = record.tick_us,
          .late_us = record.late_us,
          .state_hash = record.state_hash};
}

TickRecord recordOf(const hapto_tick& tick) noexcept {
  return {.time_s = tick.time_s,
          .device = {.pose = pose(tick.device_pose),
                     .twist = twist(tick.device_twist),
                     .gripper_open = tick.gripper_open,
                     .buttons = tick.buttons,
                     .state = static_cast<DeviceState>(tick.device_state)},
          .scene_T_tool = pose(tick.scene_T_tool),
          .soil = wrench(tick.soil),
          .rendered = {wrench(tick.rendered), tick.rendered_gripper_n},
          .felt = {wrench(tick.felt), tick.felt_gripper_n},
          .injected_j = tick.injected_j,
          .quick_injected_j = tick.quick_injected_j,
          .tick_us = tick.tick_us,
          .late_us = tick.late_us,
          .state_hash = tick.state_hash,
          .flags = tick.flags,
          .trip = static_cast<std::uint8_t>(tick.trip)};
}

}  // namespace haptolith::library
