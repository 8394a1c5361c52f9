#pragma once

#include "haptolith/device/hand/arm.h"
#include "haptolith/scene/scene.h"
#include "haptolith/teleop/robot/force_sensor.h"
#include "haptolith/teleop/robot/robot_arm.h"

namespace haptolith {

/// A compliant arm with a force sensor whose tool digs in a separate bed.
class SimulatedArm final : public RobotArm {
 public:
  /// @param scene  its bed and tool; it puts the tool at home.
  /// @param surface_m  height of the soil's surface in that scene: the site frame's zero.
  SimulatedArm(const ArmParameters& arm, double max_force_n, const ForceSensorParameters& sensor, Scene& scene,
               double surface_m, const Pose& home);

  [[nodiscard]] ArmReading move(const HandState& wanted, bool commanded) noexcept override;
  void tare() noexcept override { sensor_.tare(); }
  [[nodiscard]] bool ready() const noexcept override { return sensor_.tared(); }

 private:
  ArmParameters arm_;
  double max_force_n_;
  Scene& scene_;
  double surface_m_, tick_s_;
  ForceSensor sensor_;
  Movement tool_;
  Wrench met_;
};

}  // namespace haptolith
