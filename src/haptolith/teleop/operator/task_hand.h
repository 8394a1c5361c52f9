#pragma once

#include <optional>
#include <string_view>

#include "haptolith/core/movement.h"
#include "haptolith/device/hand/arm.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// A hand that follows a TaskOperator, and yields to force as its arm does; or releases the tool,
/// which is then as free as a device's handle.
class TaskHand final : public HapticDevice {
 public:
  /// @param arm  none: it yields to nothing. @param start  in the frame of the scene.
  TaskHand(const std::optional<ArmParameters>& arm, const DeviceLimits& limits, double tick_s, const Pose& start);

  void want(const Pose& pose) noexcept { next_ = pose; }
  /// From now on no hand holds the tool, which moves on as it did.
  void releaseTool(const Movement& tool) noexcept;

  [[nodiscard]] std::string_view name() const noexcept override { return "operator with a task"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return limits_; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const DeviceOutput& output) noexcept override { displayed_ = output.wrench; }
  void releaseForce() noexcept override { displayed_ = {}; }
  void resumeForce() noexcept override {}

 private:
  std::optional<ArmParameters> arm_;
  DeviceLimits limits_;
  double tick_s_;
  Pose wanted_, next_;
  Movement tool_;
  Wrench displayed_;
};

}  // namespace haptolith
