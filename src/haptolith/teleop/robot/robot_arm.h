#pragma once

#include "haptolith/core/movement.h"

namespace haptolith {

/// What an arm tells after a tick, site frame.
struct ArmReading {
  Movement tool;
  Wrench met;                 ///< of the soil on the tool, about the tool's origin, as its force sensor tells it
  bool at_force_cap = false;  ///< it may pull no harder
  bool fault = false;         ///< a reading makes no sense
};

/// What carries a robot's tool, and measures the force on it.
class RobotArm {
 public:
  virtual ~RobotArm() = default;

  /// A tick: takes the tool where it is wanted. Once a tick, from one thread.
  /// @param commanded  whether anybody wants it there; else the arm is left alone.
  [[nodiscard]] virtual ArmReading move(const HandState& wanted, bool commanded) noexcept = 0;

  /// Finds the force sensor's zero anew, the tool hanging still in the air.
  virtual void tare() noexcept = 0;
  /// Whether it knows where the tool is, and its force sensor's zero.
  [[nodiscard]] virtual bool ready() const noexcept = 0;
};

}  // namespace haptolith
