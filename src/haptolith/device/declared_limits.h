#pragma once

#include <string>
#include <string_view>

#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// What a device declares, as JSON, and back. @throws Failure for any other text.
[[nodiscard]] std::string limitsText(const DeviceLimits& limits, bool simulated);
struct DeclaredLimits {
  DeviceLimits limits;
  bool simulated = false;
};
[[nodiscard]] DeclaredLimits limitsOf(std::string_view text);

}  // namespace haptolith
