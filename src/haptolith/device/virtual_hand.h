#pragma once

#include <optional>

#include "haptolith/device/hand_parameters.h"
#include "haptolith/device/haptic_device.h"
#include "haptolith/device/pose_file.h"

namespace haptolith {

/// A device without hardware: a human arm that pulls the tool along a manoeuvre and yields to what it feels.
///
///     m x'' = K (x_d - x) + B (x_d' - x') + F        x_d: the manoeuvre, F: the soil's force on the tool
///
/// and likewise for rotation with m l^2, K l^2, B l^2 (l = hand.lever_m). One semi-implicit step a tick. The arm's own
/// weight and the tool's are carried by the arm, so that the tool weighs nothing, as in the paper.
class VirtualHand final : public HapticDevice {
 public:
  /// @throws InvalidParameter, Failure: as validate(HandParameters) and PoseFile::read(), and for an arm so stiff or
  /// damped for its mass that a tick cannot follow it.
  VirtualHand(const HandParameters& hand, double tick_s);

  [[nodiscard]] std::string_view name() const noexcept override { return "virtual hand"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return {hand_.max_force_n, hand_.max_torque_nm}; }
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const Wrench& wrench) noexcept override { felt_ = wrench; }

 private:
  [[nodiscard]] Pose wanted(double time_s) const noexcept;
  void yield(const Pose& wanted_pose, const Twist& wanted_twist) noexcept;

  HandParameters hand_;
  double tick_s_;
  std::optional<PoseFile> poses_;
  std::uint64_t ticks_ = 0;
  Pose pose_;
  Twist twist_;
  Wrench felt_;
};

}  // namespace haptolith
