#pragma once

#include <cstdint>

#include "haptolith/core/vec.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// What the safety layer did to a tick; bits of TickRecord::flags.
enum TickFlag : std::uint32_t {
  kTickLate = 1,            ///< did not end in time
  kTickForceZeroed = 2,     ///< zero force, for the reason in `trip`
  kTickForceSaturated = 4,  ///< shortened to what the device can show
  kTickForceRateLimited = 8,
  kTickSoftStart = 16,
  kTickPassivityDamped = 32,
  kTickResumed = 64,         ///< time stood still before it
  kTickHeartbeatLost = 128,  ///< the watchdog had let go of the hand
  kTickSoftStop = 512,       ///< the run was about to end
  kTickFailed = 1024,       ///< the run ended with it: the device is gone, or the bed or the hand no longer makes sense
  kTickSceneChanged = 256,  ///< somebody has changed soil, gravity, tool or bed, or the tool fades for that
  kTickSoilAdjusted = 2048,  ///< soil and tool friction were changed a little: see request::Adjust
  kTickGrainMoved = 4096,    ///< a grain was to lie elsewhere: see request::MoveGrain
};

/// One tick, as it is recorded.
struct TickRecord {
  double time_s = 0;
  DeviceInput device;  ///< as the device told it, in its own frame
  Pose scene_T_tool;
  Wrench soil;                   ///< of the soil on the tool, unfiltered, scene frame
  DeviceOutput rendered;         ///< what the hand would feel without the safety layer, device's frame
  DeviceOutput felt;             ///< what it was made to feel
  double injected_j = 0;         ///< Passivity::injected()
  double quick_injected_j = 0;   ///< Passivity::quickInjected()
  double tick_us = 0;            ///< work of this tick, without sleep
  double late_us = 0;            ///< how late it began
  std::uint64_t state_hash = 0;  ///< of the part of the bed that was hashed in this tick; 0 when nobody asked for it
  std::uint32_t flags = 0;
  std::uint8_t trip = 0;  ///< SafetyTrip
};

}  // namespace haptolith
