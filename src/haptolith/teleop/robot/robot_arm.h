#pragma once

#include "haptolith/core/movement.h"

namespace haptolith {

/// Reading of an arm after a tick, site frame.
struct ArmReading {
  Movement tool;
  Wrench met;                 ///< soil on tool, about the tool's origin, from its force sensor
  bool at_force_cap = false;  ///< it may pull no harder
  bool fault = false;         ///< a reading makes no sense
};

/// Carries a robot's tool, and measures the force on it.
class RobotArm {
 public:
  virtual ~RobotArm() = default;

  /// A tick: takes the tool where it is wanted. Once a tick, from one thread.
  /// @param commanded  whether there is a command; otherwise the arm is left alone.
  [[nodiscard]] virtual ArmReading move(const HandState& wanted, bool commanded) noexcept = 0;

  /// Zeroes the force sensor, with the tool at rest in the air.
  virtual void tare() noexcept = 0;
  /// Whether it knows where the tool is, and its force sensor's zero.
  [[nodiscard]] virtual bool ready() const noexcept = 0;
};

}  // namespace haptolith
