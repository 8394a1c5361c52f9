#pragma once

#include "haptolith/core/vec.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Low-pass of first order for force and torque (paper, II-E: 30 Hz).
///
///     y += (1 - exp(-2 pi f_c dt)) (x - y)
///
/// This is the step-invariant discretisation: the answer to a step is 1 - exp(-2 pi f_c t) exactly at every tick. First
/// order, because each further order adds delay, and delay between hand and soil costs stability. What is left of a
/// force that has ended is cut to exactly zero once it is too small to feel.
class WrenchFilter {
 public:
  /// @param cutoff_hz  above 0, at most half the tick rate. @throws InvalidParameter.
  WrenchFilter(double cutoff_hz, double tick_s);

  /// May be called in the tick.
  const Wrench& step(const Wrench& input) noexcept;

 private:
  double share_;
  Wrench output_;
};

/// `wrench` with force and torque shortened to what the device can show; directions stay. May be called in the tick.
[[nodiscard]] Wrench limited(const Wrench& wrench, const DeviceLimits& limits) noexcept;

}  // namespace haptolith
