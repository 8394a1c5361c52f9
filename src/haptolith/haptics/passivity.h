#pragma once

#include <array>
#include <cstddef>

#include "haptolith/core/vec.h"
#include "haptolith/device/haptic_device.h"
#include "haptolith/haptics/wrench_filter.h"

namespace haptolith {

/// Observes the energy that the hand is given and damps what soil could not give: time-domain passivity (Hannaford and
/// Ryu 2002, IEEE Trans. Robotics and Automation 18:1), device's frame.
///
///     E += F_held . dx + T_held . dr          F_held: what was shown between the two readings
///
/// Two accounts. The whole one begins at zero, and soil that nobody has pressed has nothing to give: E > 0 is an error.
/// But digging dissipates so much that it could hide seconds of shaking, and a load that is lowered rightly gives
/// energy back. So the quick one counts what is above 6 Hz, where no person moves on purpose and gravity does no work.
/// What it can owe is no more than springs hold that are pressed so hard, it forgets within a quarter of a second, and
/// 2 mJ are forgiven, since soil that slips under a hand rightly gives so much; but a tenth of that while it goes on.
///
///     E_quick >= -F_quick^2 / (2 k)
///
/// What is in excess is taken back with a damper, F -= alpha v, alpha = E / (dt v^2), as far as a damper may go.
///
/// A force that is shown T late may push where the hand presses no more, and so may the damper's. In that time it can
/// give the hand F T (v + F T / 2 m) at most, m being the lightest handle. No more force is shown than the hand has
/// paid for: that energy stays below what the whole account has left, and half a millijoule of credit.
///
///     F <= m / T (sqrt(v^2 + 2 (0.5 mJ - E) / m) - v)
///
/// Functions may be called in the tick.
class Passivity {
 public:
  /// @param stiffness_n_m  k of the softest spring that stores what the hand presses with.
  /// @param delay_s        the device's: a force is held against the movement that many seconds later, 31 ticks at
  /// most.
  Passivity(double stiffness_n_m, double delay_s, double tick_s) noexcept;

  /// Accounts for the time since the last call, during which `held` was sent.
  void observe(const Pose& device, const Wrench& sent) noexcept;

  /// What to add to the wrench: zero while nothing is in excess.
  [[nodiscard]] Wrench damping() const noexcept;

  /// How much of this wrench the hand has paid for, 0 to 1; all of it when the device shows it at once.
  [[nodiscard]] double affordable(const Wrench& wrench) const noexcept;

  /// Forgets where the device was, how it moved and what was sent, but not what has been dissipated: it is somewhere
  /// else, or has not been looked at for a while.
  void restart() noexcept;

  [[nodiscard]] double injected() const noexcept { return whole_j_; }       ///< J, whole account
  [[nodiscard]] double quickInjected() const noexcept { return quick_j_; }  ///< J, quick account

 private:
  double stiffness_n_m_, tick_s_;
  bool known_ = false;
  Pose last_;
  Twist twist_, quick_twist_;
  QuickMovement quick_velocity_, quick_rotation_, quick_force_, quick_torque_;
  std::array<Wrench, 32> sent_;  ///< in the last ticks, round and round
  std::size_t delay_, calls_ = 0;
  double whole_j_ = 0, quick_j_ = 0, forgiven_j_;
};

}  // namespace haptolith
