#pragma once

#include <string>
#include <string_view>

#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// A device that repeats the readings and the declared limits of a recorded one, tick by tick.
class ReplayDevice final : public HapticDevice {
 public:
  ReplayDevice(std::string name, const DeviceLimits& limits, bool simulated)
      : name_(std::move(name)), limits_(limits), simulated_(simulated) {}

  /// Sets the next reading. From the loop's thread.
  void feed(const DeviceInput& input) noexcept { input_ = input; }

  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return limits_; }
  [[nodiscard]] bool simulated() const noexcept override { return simulated_; }
  [[nodiscard]] DeviceInput read() noexcept override { return input_; }
  void write(const DeviceOutput& /*output*/) noexcept override {}
  void releaseForce() noexcept override {}
  void resumeForce() noexcept override {}

 private:
  std::string name_;
  DeviceLimits limits_;
  bool simulated_;
  DeviceInput input_;
};

}  // namespace haptolith
