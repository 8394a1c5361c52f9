#pragma once

#include <string>
#include <string_view>

#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Writes the declared limits of a device as JSON; limitsOf() reads them. @throws Failure for any other text.
[[nodiscard]] std::string limitsText(const DeviceLimits& limits, bool simulated);
struct DeclaredLimits {
  DeviceLimits limits;
  bool simulated = false;
};
[[nodiscard]] DeclaredLimits limitsOf(std::string_view text);

}  // namespace haptolith
