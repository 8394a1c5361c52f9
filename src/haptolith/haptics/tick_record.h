#pragma once

#include <cstdint>

#include "haptolith/core/movement.h"
#include "haptolith/core/vec.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Bits of TickRecord::flags; also in recordings, and HAPTO_TICK_... in the library.
enum TickFlag : std::uint32_t {
  kTickLate = 1,              ///< did not end in time
  kTickForceZeroed = 2,       ///< zero force, for the reason in `trip`
  kTickForceSaturated = 4,    ///< force was shortened to what the device can show
  kTickForceRateLimited = 8,  ///< force changed no faster than the device may
  kTickSoftStart = 16,        ///< force was still rising after a start or a trip
  kTickPassivityDamped = 32,  ///< energy in excess was damped
  kTickResumed = 64,          ///< time was paused before it
  kTickHeartbeatLost = 128,   ///< the watchdog had set the force to zero before it
  kTickSceneChanged = 256,    ///< soil, gravity, tool or bed were changed before it, or the tool fades for that
  kTickSoftStop = 512,        ///< the run was about to end
  kTickFailed = 1024,  ///< the run ended with it: the device is gone, or the bed or the hand no longer makes sense
  kTickSoilAdjusted = 2048,   ///< soil and tool friction were changed a little: see request::Adjust
  kTickParticleMoved = 4096,  ///< a grain was put elsewhere: see request::MoveGrain
};

/// One tick of one tool, as it is recorded.
struct TickRecord {
  double time_s = 0;
  DeviceInput device;  ///< as the device reported it, device frame
  Pose scene_T_tool;
  Wrench soil;                   ///< soil on tool, about the tool's origin, scene frame, unfiltered
  DeviceOutput rendered;         ///< output before the safety layer, device frame
  DeviceOutput sent;             ///< device wrench: output that the device was sent, device frame
  double injected_j = 0;         ///< Passivity::injected()
  double quick_injected_j = 0;   ///< Passivity::quickInjected()
  double tick_us = 0;            ///< work of this tick, without sleep
  double late_us = 0;            ///< lateness of its begin
  std::uint64_t state_hash = 0;  ///< hash of the part of the bed that was hashed in this tick; 0 unless requested
  std::uint32_t flags = 0;
  std::uint8_t trip = 0;  ///< SafetyTrip
  std::uint8_t tool = 0;  ///< number of the tool
  JointState joint;       ///< the tool's joint; zero without one
};

}  // namespace haptolith
