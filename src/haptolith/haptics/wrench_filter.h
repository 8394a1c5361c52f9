#pragma once

#include "haptolith/core/vec.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Low-pass of first order for force and torque (paper, II-E: 30 Hz).
///
///     y += (1 - exp(-2 pi f_c dt)) (x - y)
///
/// This is the step-invariant discretisation: the answer to a step is 1 - exp(-2 pi f_c t) exactly at every tick. First
/// order, because each further order adds delay, and delay between hand and soil costs stability. The rest of an
/// ended force is set to exactly zero once it is below the detection threshold.
class WrenchFilter {
 public:
  /// @param cutoff_hz  above 0, at most half the tick rate. @throws InvalidParameter.
  WrenchFilter(double cutoff_hz, double tick_s);

  /// Filters a wrench about a fixed origin, device frame.
  /// @param own_change_n  change of force in this tick that the hand's own quick movement explains (see QuickMovement);
  ///                      it passes at once, the rest of the change is filtered. May be called in the tick.
  const Wrench& step(const Wrench& input, const Vec3& own_change_n = Vec3::Zero()) noexcept;

 private:
  double share_;
  Wrench output_;
};

/// As WrenchFilter, for the force between the fingers.
class GripFilter {
 public:
  /// As WrenchFilter().
  GripFilter(double cutoff_hz, double tick_s);

  /// May be called in the tick.
  double step(double grip_n) noexcept;

 private:
  double share_;
  double output_n_ = 0;
};

/// The quick part of a movement: velocity less its own low-pass at 6 Hz.
///
/// A low-pass between soil and hand delays the answer to the hand's own movement. Against n contacts of stiffness
/// k_tool that delay acts like negative damping, -n k_tool / (2 pi f_c), more than an arm has: a shovel between
/// compacted particles would oscillate. But this response needs no waiting: it is -stiffness times the
/// movement, with the stiffness of those contacts that hold (see ToolReaction). Slow movements are left to the
/// low-pass, where their delay does no harm.
class QuickMovement {
 public:
  explicit QuickMovement(double tick_s) noexcept;

  /// The quick part of `velocity_m_s`. May be called in the tick.
  [[nodiscard]] Vec3 step(const Vec3& velocity_m_s) noexcept;

 private:
  double share_;
  Vec3 slow_m_s_ = Vec3::Zero();
};

/// `wrench` (device frame) with force and torque shortened to the device's limits; directions stay. May be called in
/// the tick.
[[nodiscard]] Wrench limited(const Wrench& wrench, const DeviceLimits& limits) noexcept;

}  // namespace haptolith
