#pragma once

#include <string>

#include "haptolith/device/device_parameters.h"
#include "haptolith/device/drivers/force_dimension_sdk.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

inline constexpr const char* kForceDimensionSdkRemedy =
    "install the SDK from forcedimension.com (3.14 or newer) and name its folder in FORCEDIM_SDK or with "
    "--device-library";

/// Why no device can be opened, and what to do.
[[nodiscard]] DeviceReport whyNoForceDimension(const ForceDimensionPlaces& places, const std::string& what_failed);

/// @throws Failure with the report's reason and remedy.
[[noreturn]] void failWith(const DeviceReport& report);

/// Index of the device that `id` means in the SDK's list, as its opening functions number it. @throws Failure.
[[nodiscard]] int forceDimensionIndex(const std::string& id, const ForceDimensionSdk& sdk,
                                      const ForceDimensionPlaces& places);

}  // namespace haptolith
