#pragma once

#include "haptolith/core/error.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Protection between the simulation and a person's hand. On by default.
struct SafetyParameters {
  double soft_start_s = 2;                   ///< forces grow from nothing in this time, at first and after every trip
  double soft_stop_s = 0.2;                  ///< and fall to nothing in this time when a run ends in good order
  int max_missed_deadlines = 20;             ///< consecutive missed deadlines that are tolerated
  double watchdog_timeout_s = 0.004;         ///< longest time without a tick before the watchdog trips
  double recovery_s = 1;                     ///< time without a fault before forces return
  bool passivity = true;                     ///< whether excess energy is damped; it is observed in any case
  double max_force_n = DeviceLimits::kNone;  ///< less than the device could show, if one likes
  double max_torque_nm = DeviceLimits::kNone;

  [[nodiscard]] bool operator==(const SafetyParameters&) const = default;
};

/// Valid ranges; a limit may also be DeviceLimits::kNone.
struct SafetyRanges {
  static constexpr Range soft_start_s{0, 60};
  static constexpr Range soft_stop_s{0, 5};
  static constexpr Range max_missed_deadlines{1, 1000};
  static constexpr Range watchdog_timeout_s{0.002, 1};
  static constexpr Range recovery_s{0, 60};
  static constexpr Range max_force_n{0, 1000};
  static constexpr Range max_torque_nm{0, 1000};
};

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const SafetyParameters& safety);

}  // namespace haptolith
