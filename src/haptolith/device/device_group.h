#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Several devices whose forces are released together, in the last resort. Nothing is read from them or written.
class DeviceGroup final : public HapticDevice {
 public:
  /// @param devices  that live as long as this.
  explicit DeviceGroup(std::vector<HapticDevice*> devices) : devices_(std::move(devices)) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "devices"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return {}; }
  [[nodiscard]] DeviceInput read() noexcept override { return {}; }
  void write(const DeviceOutput& /*output*/) noexcept override {}

  void releaseForce() noexcept override {
    for (HapticDevice* device : devices_) {
      device->releaseForce();
    }
  }
  /// The least that has been reached of any.
  [[nodiscard]] ForceRelease forceRelease() const noexcept override {
    const auto any = [&](ForceRelease how) {
      return std::ranges::any_of(devices_, [how](const HapticDevice* device) { return device->forceRelease() == how; });
    };
    return any(ForceRelease::kStuck)      ? ForceRelease::kStuck
           : any(ForceRelease::kUnderWay) ? ForceRelease::kUnderWay
                                          : ForceRelease::kDone;
  }
  void releaseForceRegardless() noexcept override {
    for (HapticDevice* device : devices_) {
      device->releaseForceRegardless();
    }
  }
  void resumeForce() noexcept override {
    for (HapticDevice* device : devices_) {
      device->resumeForce();
    }
  }

 private:
  std::vector<HapticDevice*> devices_;
};

}  // namespace haptolith
