#pragma once

#include <memory>
#include <vector>

#include "haptolith/device/device_parameters.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Opens a device that a person holds; a sigma.7 finds its zero by moving its handle, which takes seconds. Not for
/// kVirtualHand, which has no hardware.
/// @throws Failure with the attempts and a remedy; InvalidParameter for an invalid address.
[[nodiscard]] std::unique_ptr<HapticDevice> openDevice(const DeviceParameters& parameters, double tick_s);

/// Available devices, and reasons for missing ones: at least one report for each kind of device. Opens nothing.
[[nodiscard]] std::vector<DeviceReport> findDevices(const DeviceParameters& parameters = {});

}  // namespace haptolith
