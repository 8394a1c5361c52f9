#pragma once

#include <cstdint>

#include "haptolith/core/ramp.h"
#include "haptolith/device/haptic_device.h"
#include "haptolith/haptics/safety/passivity.h"
#include "haptolith/haptics/safety/plausibility.h"
#include "haptolith/haptics/safety/safety_parameters.h"

namespace haptolith {

/// Causes of a safety trip. Recordings hold the numbers; HAPTO_TRIP_... in the library.
enum class SafetyTrip : std::uint8_t {
  kNone = 0,
  kDeviceNotFinite = 1,  ///< the pose or velocity from the device is NaN or infinite
  kStale = 2,            ///< no new reading from the device
  kLost = 3,             ///< the device is gone
  kWorkspace = 4,        ///< the hand left the workspace, or the tool the space around the bed
  kMissedDeadlines = 5,  ///< too many in a row
  kHeartbeat = 6,        ///< the loop did not answer
  kForceNotFinite = 7,   ///< the force for the hand is NaN or infinite
  kImplausible = 8,      ///< no hand moves as the device reports
};

[[nodiscard]] const char* text(SafetyTrip trip) noexcept;

/// Health of the loop itself.
struct LoopHealth {
  bool late = false;            ///< the last tick did not end in time
  bool heartbeat_lost = false;  ///< the watchdog has tripped
};

/// The one place between what is simulated and what a hand is made to feel, device's frame.
///
/// check() first decides whether the input is plausible; when not, the hand feels exactly nothing, until all has been
/// well for a while, and then force returns with a soft start. step() then shortens force and torque to what the device
/// can show, damps energy in excess (Passivity), and limits how fast they change; only to zero they may jump. Functions
/// may be called in the tick.
class SafetyLayer {
 public:
  /// @param storage_n_m  see Passivity. @throws InvalidParameter as validate().
  /// @param simulated    no person's hand is at the device: neither soft start nor stop, and deadlines may be missed.
  SafetyLayer(const SafetyParameters& parameters, const DeviceLimits& limits, bool simulated, double storage_n_m,
              double tick_s);

  /// Checks the device's reading and the loop's health, before anything else uses them.
  void check(const DeviceInput& input, const LoopHealth& health) noexcept;

  /// The hand feels nothing from now on, until check() has found all well for a while.
  void releaseForce(SafetyTrip why) noexcept;

  /// Device wrench to send instead of `rendered` plus `weight`, device frame, about the handle's origin.
  /// @param weight  of the tool, in the device's frame. Gravity returns the work of lifting: the rendered
  /// part of it is excluded from Passivity.
  DeviceOutput step(const DeviceOutput& rendered, const Wrench& weight = {}) noexcept;

  /// Fades the force to zero because the run is about to end; returns whether it is zero. After a trip it already
  /// is.
  void stop() noexcept { stopping_ = true; }
  [[nodiscard]] bool stopped() const noexcept;

  /// Nothing was shown for a while: begin again with a soft start.
  void restart() noexcept;

  [[nodiscard]] SafetyTrip trip() const noexcept { return trip_; }
  /// Whether the last check() found nothing wrong, which after a trip has to last for a while.
  [[nodiscard]] bool allWell() const noexcept { return trip_ == SafetyTrip::kNone || well_for_ > 0; }
  /// Whether force has just gone (not when there has never been any: a device that has yet to be held), and whether the
  /// trip has just ended: for one tick each.
  [[nodiscard]] bool justTripped() const noexcept { return just_tripped_; }
  [[nodiscard]] bool justRecovered() const noexcept { return just_recovered_; }
  [[nodiscard]] std::uint32_t trips() const noexcept { return trips_; }
  [[nodiscard]] std::uint32_t flags() const noexcept { return flags_; }  ///< TickFlag, of the last step()
  [[nodiscard]] const Passivity& passivity() const noexcept { return passivity_; }

 private:
  [[nodiscard]] SafetyTrip reason(const DeviceInput& input, const LoopHealth& health) noexcept;
  [[nodiscard]] DeviceOutput limited(const DeviceOutput& wanted) noexcept;
  [[nodiscard]] DeviceOutput reachable(const DeviceOutput& wanted) noexcept;
  void startOrStopSoftly() noexcept;
  [[nodiscard]] DeviceOutput dampedForPassivity(DeviceOutput wanted) noexcept;

  DeviceLimits limits_;
  bool simulated_, damps_;
  double tick_s_, soft_start_s_, soft_stop_s_;
  int max_missed_deadlines_, recovery_ticks_;
  Plausibility plausibility_;
  Passivity passivity_;

  SafetyTrip trip_ = SafetyTrip::kNone;
  bool begun_ = false;  ///< whether all has been well before
  bool just_tripped_ = false, just_recovered_ = false, stopping_ = false;
  std::uint32_t trips_ = 0, flags_ = 0;
  int misses_ = 0, well_for_ = 0;
  Ramp soft_start_;                 ///< share of the force
  DeviceOutput held_;               ///< device wrench now, device frame
  Wrench held_weight_, held_soil_;  ///< parts of it: the tool's weight, and the rest; device frame
};

}  // namespace haptolith
