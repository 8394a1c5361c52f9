#include "haptolith/haptics/safety/safety_parameters.h"

#include "haptolith/core/error.h"

namespace haptolith {

void validate(const SafetyParameters& safety) {
  requireInRange("soft_start_s", safety.soft_start_s, SafetyRanges::soft_start_s);
  requireInRange("soft_stop_s", safety.soft_stop_s, SafetyRanges::soft_stop_s);
  requireInRange("most_misses", safety.most_misses, SafetyRanges::most_misses);
  requireInRange("heartbeat_s", safety.heartbeat_s, SafetyRanges::heartbeat_s);
  requireInRange("calm_s", safety.calm_s, SafetyRanges::calm_s);
  if (safety.max_force_n != DeviceLimits::kNone) {
    requireInRange("max_force_n", safety.max_force_n, SafetyRanges::max_force_n);
  }
  if (safety.max_torque_nm != DeviceLimits::kNone) {
    requireInRange("max_torque_nm", safety.max_torque_nm, SafetyRanges::max_torque_nm);
  }
}

}  // namespace haptolith
