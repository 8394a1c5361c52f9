#pragma once

#include <atomic>
#include <optional>

#include "haptolith/core/process/latest_value.h"
#include "haptolith/device/hand/arm.h"
#include "haptolith/device/hand/hand_command.h"
#include "haptolith/device/hand/hand_parameters.h"
#include "haptolith/device/hand/pose_file.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// A device without hardware: a human arm (moveArm()) that pulls the tool along a motion and yields to
/// force, until a client takes the tool. The arm's own weight and the tool's are carried by the arm, so that
/// the tool weighs nothing, as in the paper.
class VirtualHand final : public HapticDevice {
 public:
  /// @throws InvalidParameter, Failure: as validate(HandParameters) and PoseFile::read(), and for an arm so stiff or
  /// damped for its mass that a tick cannot follow it.
  VirtualHand(const HandParameters& hand, double tick_s);

  static constexpr std::string_view kName = "virtual hand";
  /// The coupling of a tool that is pulled by hand: an arm's mass, stiffer than it so that the tool keeps up with a
  /// mouse, and critically damped so that it does not swing.
  static constexpr ArmParameters kPull{.mass_kg = 0.3, .damping_n_s_m = 19, .stiffness_n_m = 300, .lever_m = 0.1};
  [[nodiscard]] std::string_view name() const noexcept override { return kName; }
  /// Its frame is the scene's. It shows what a sigma.7 shows.
  [[nodiscard]] DeviceLimits limits() const noexcept override;
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const DeviceOutput& output) noexcept override { output_ = output.wrench; }
  void releaseForce() noexcept override { released_.store(true, std::memory_order_relaxed); }
  void resumeForce() noexcept override { released_.store(false, std::memory_order_relaxed); }

  /// For one other thread: sets the target of the tool. The tool follows through a virtual coupling that pulls with at
  /// most the device's largest force, so that it cannot be forced through the soil. May be called at any time.
  void command(const HandCommand& command) noexcept;

 private:
  void takeCommand() noexcept;
  void followMotion() noexcept;
  void followCommand(const Pose& held) noexcept;
  [[nodiscard]] Pose wanted(double time_s) const noexcept;
  void moveGripper() noexcept;

  HandParameters hand_;
  double tick_s_;
  std::optional<PoseFile> poses_;
  std::uint64_t ticks_ = 0;  ///< ticks of the motion
  Movement tool_;
  double gripper_open_ = 1;
  Wrench output_;
  std::atomic<bool> released_{false};

  LatestValue<HandCommand> commands_;
  std::uint32_t beginnings_ = 0;
  Pose smooth_;                      ///< the held pose, its steps rounded off
  std::optional<Pose> return_from_;  ///< on the way back to a motion
  std::uint64_t return_ticks_ = 0;   ///< ticks on that way
};

}  // namespace haptolith
