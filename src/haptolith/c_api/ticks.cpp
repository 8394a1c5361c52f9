#include "haptolith/c_api/ticks.h"

#include "haptolith/c_api/values.h"
#include "haptolith/haptics/safety/safety_layer.h"

namespace haptolith::library {

// Ticks lie in arrays of the caller's: one of another size would shift all that follow it.
static_assert(sizeof(hapto_tick) == 400);

static_assert(HAPTO_TICK_LATE == static_cast<int>(kTickLate) &&
              HAPTO_TICK_ZEROED == static_cast<int>(kTickForceZeroed) &&
              HAPTO_TICK_SATURATED == static_cast<int>(kTickForceSaturated) &&
              HAPTO_TICK_RATE_LIMITED == static_cast<int>(kTickForceRateLimited) &&
              HAPTO_TICK_SOFT_START == static_cast<int>(kTickSoftStart) &&
              HAPTO_TICK_DAMPED == static_cast<int>(kTickPassivityDamped) &&
              HAPTO_TICK_RESUMED == static_cast<int>(kTickResumed) &&
              HAPTO_TICK_HEARTBEAT_LOST == static_cast<int>(kTickHeartbeatLost) &&
              HAPTO_TICK_SCENE_CHANGED == static_cast<int>(kTickSceneChanged) &&
              HAPTO_TICK_SOFT_STOP == static_cast<int>(kTickSoftStop) &&
              HAPTO_TICK_FAILED == static_cast<int>(kTickFailed) &&
              HAPTO_TICK_SOIL_ADJUSTED == static_cast<int>(kTickSoilAdjusted) &&
              HAPTO_TICK_PARTICLE_MOVED == static_cast<int>(kTickParticleMoved));
static_assert(HAPTO_TRIP_NONE == static_cast<int>(SafetyTrip::kNone) &&
              HAPTO_TRIP_DEVICE_NOT_FINITE == static_cast<int>(SafetyTrip::kDeviceNotFinite) &&
              HAPTO_TRIP_STALE == static_cast<int>(SafetyTrip::kStale) &&
              HAPTO_TRIP_LOST == static_cast<int>(SafetyTrip::kLost) &&
              HAPTO_TRIP_WORKSPACE == static_cast<int>(SafetyTrip::kWorkspace) &&
              HAPTO_TRIP_MISSED_DEADLINES == static_cast<int>(SafetyTrip::kMissedDeadlines) &&
              HAPTO_TRIP_HEARTBEAT == static_cast<int>(SafetyTrip::kHeartbeat) &&
              HAPTO_TRIP_FORCE_NOT_FINITE == static_cast<int>(SafetyTrip::kForceNotFinite) &&
              HAPTO_TRIP_IMPLAUSIBLE == static_cast<int>(SafetyTrip::kImplausible));

hapto_tick tickOf(const TickRecord& record) noexcept {
  return {.size = sizeof(hapto_tick),
          .flags = record.flags,
          .trip = record.trip,
          .buttons = record.device.buttons,
          .device_state = static_cast<std::int32_t>(record.device.state),
          .tool = record.tool,
          .time_s = record.time_s,
          .device_pose = pose(record.device.pose),
          .device_twist = twist(record.device.twist),
          .gripper_open = record.device.gripper_open,
          .scene_T_tool = pose(record.scene_T_tool),
          .soil_wrench = wrench(record.soil),
          .rendered = wrench(record.rendered.wrench),
          .rendered_gripper_n = record.rendered.gripper_force_n,
          .device_wrench = wrench(record.sent.wrench),
          .device_gripper_n = record.sent.gripper_force_n,
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
          .soil = wrench(tick.soil_wrench),
          .rendered = {wrench(tick.rendered), tick.rendered_gripper_n},
          .sent = {wrench(tick.device_wrench), tick.device_gripper_n},
          .injected_j = tick.injected_j,
          .quick_injected_j = tick.quick_injected_j,
          .tick_us = tick.tick_us,
          .late_us = tick.late_us,
          .state_hash = tick.state_hash,
          .flags = tick.flags,
          .trip = static_cast<std::uint8_t>(tick.trip),
          .tool = static_cast<std::uint8_t>(tick.tool),
          .joint = {}};
}

}  // namespace haptolith::library
