#include "haptolith/haptics/safety/safety_parameters.h"

#include "haptolith/core/error.h"

namespace haptolith {

void validate(const SafetyParameters& safety) {
  requireInRange("soft_start_s", safety.soft_start_s, SafetyRanges::soft_start_s);
  requireInRange("soft_stop_s", safety.soft_stop_s, SafetyRanges::soft_stop_s);
  requireInRange("max_missed_deadlines", safety.max_missed_deadlines, SafetyRanges::max_missed_deadlines);
  requireInRange("watchdog_timeout_s", safety.watchdog_timeout_s, SafetyRanges::watchdog_timeout_s);
  requireInRange("recovery_s", safety.recovery_s, SafetyRanges::recovery_s);
  if (safety.max_force_n != DeviceLimits::kNone) {
    requireInRange("max_force_n", safety.max_force_n, SafetyRanges::max_force_n);
  }
  if (safety.max_torque_nm != DeviceLimits::kNone) {
    requireInRange("max_torque_nm", safety.max_torque_nm, SafetyRanges::max_torque_nm);
  }
}

}  // namespace haptolith
