#pragma once

#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/core/movement.h"
#include "haptolith/core/ramp.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Place and scale of a device's workspace in the scene.
struct MappingParameters {
  Vec3 offset_m = Vec3::Zero();  ///< centre of the device's workspace in the scene
  /// Turns the frame of the person before the device (DeviceLimits::turn_rad) into the scene's: about the scene's x,
  /// then y, then z.
  Vec3 turn_rad = Vec3::Zero();
  double scale = 1;        ///< metres in the scene for a metre at the device
  double force_scale = 1;  ///< newtons at the hand for a newton on the tool
  int clutch_button = -1;  ///< while it is down the tool stays where it is and the hand goes elsewhere; -1: none
  bool gripper = true;     ///< whether the gripper opens the tool's jaws; else they stay open

  [[nodiscard]] bool operator==(const MappingParameters&) const = default;
};

/// Valid ranges; for offset and turn those of each axis.
struct MappingRanges {
  static constexpr double kFullTurn_rad = 360 * (std::numbers::pi / 180);
  static constexpr Range offset_m{-10, 10};
  static constexpr Range turn_rad{-kFullTurn_rad, kFullTurn_rad};
  static constexpr Range scale{0.01, 100};
  static constexpr Range force_scale{0, 100};
  static constexpr Range clutch_button{-1, 31};
};

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const MappingParameters& mapping);

/// Between the device's frame and the scene's:
///
///     x_scene = a_scene + s R (x_device - a_device)        q_scene = R q_device R^-1 b
///     F_device = s_F R^-1 F_scene                          T_device = s_F / s R^-1 T_scene
///
/// Levers are s times shorter at the device, therefore the torque: power at the device is s_F / s of that in the scene,
/// the same where s_F = s. The anchors a and b move when the clutch has been held, so that the tool never jumps, and
/// force comes back within 0.2 s. All functions may be called in the tick.
class Mapping {
 public:
  /// @throws InvalidParameter as validate().
  Mapping(const MappingParameters& parameters, const DeviceLimits& device, double tick_s);

  /// Pose of the tool in the hand. While the clutch is held: the last pose, at rest, without force on the hand.
  /// Without a gripper the jaws stay open.
  [[nodiscard]] HandState toScene(const DeviceInput& input) noexcept;
  /// Output for the device, device frame, of a force on the tool, scene frame.
  [[nodiscard]] DeviceOutput toDevice(const ToolForce& scene) const noexcept;
  /// A wrench of the device frame turned into the scene's axes, as large as it is at the device.
  [[nodiscard]] Wrench turnedIntoScene(const Wrench& device) const noexcept;

 private:
  MappingParameters mapping_;
  Quat turn_;
  Vec3 anchor_device_m_, anchor_scene_m_;
  Quat anchor_turn_ = Quat::Identity();  ///< b
  Pose tool_;                            ///< the last one
  bool known_ = false;                   ///< whether there is a last one
  bool clutched_ = false;
  double tick_s_;
  Ramp clutch_{1};  ///< share of the force that the hand feels: less than 1 after the clutch
};

}  // namespace haptolith
