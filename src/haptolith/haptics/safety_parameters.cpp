#include "haptolith/haptics/safety_parameters.h"

#include "haptolith/core/error.h"

namespace haptolith {

void validate(const SafetyParameters& safety) {
  requireInRange("soft_start_s", safety.soft_start_s, {0, 60});
  requireInRange("soft_stop_s", safety.soft_stop_s, {0, 5});
  requireInRange("most_misses", safety.most_misses, {1, 1000});
  requireInRange("heartbeat_s", safety.heartbeat_s, {0.002, 1});
  requireInRange("calm_s", safety.calm_s, {0, 60});
  for (const auto& [key, limit] :
       {std::pair{"max_force_n", safety.max_force_n}, {"max_torque_nm", safety.max_torque_nm}}) {
    if (limit != DeviceLimits::kNone) {
      requireInRange(key, limit, {0, 1000});
    }
  }
}

}  // namespace haptolith
