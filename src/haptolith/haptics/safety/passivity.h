#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "haptolith/core/vec.h"
#include "haptolith/device/haptic_device.h"
#include "haptolith/haptics/wrench_filter.h"

namespace haptolith {

/// Properties of soil and device that the controller needs.
struct PassivityParameters {
  double stiffness_n_m = 0;  ///< k of the softest spring that stores what the hand presses with
  double delay_s = 0;        ///< from a force that is sent to one that acts, 31 ticks at most
  bool delay_known = true;   ///< else it is anything up to delay_s
  /// Resolution of positions, or amplitude of their noise. 0: they are exact, and nothing below
  /// about dead bands, noise and shaking applies, as for a simulated hand.
  double resolution_m = 0;
};

/// Observes the energy that the hand is given and damps what soil could not give: time-domain passivity (Hannaford and
/// Ryu 2002, IEEE Trans. Robotics and Automation 18:1), device's frame.
///
///     E += F_held . dx + T_held . dr          F_held: what was shown between the two readings
///
/// dx passes a dead band as wide as the device's resolution, or as the measured noise: a handle at rest whose
/// reading flips between two steps does no work, although stiff soil responds to each step with a force.
///
/// Two accounts. The total one begins at zero, and soil that has not been pressed stores nothing: E > 0 is an error.
/// But digging dissipates so much that it could hide seconds of shaking, and a load that is lowered rightly gives
/// energy back. So the quick one counts energy above 6 Hz, where no person moves on purpose and gravity does no work.
/// Its balance is limited by the energy of springs under that force, it forgets within a quarter of a second, and
/// 2 mJ are tolerated, because soil that slips under a hand rightly returns that much; but a tenth of that while it
/// lasts.
///
///     E_quick >= -F_quick^2 / (2 k)
///
/// Both are kept for each delay that the device may have, and the worst counts: a force that is shown later than it was
/// sent pushes where it should have braked.
///
/// Excess is dissipated by a damper, F -= alpha v, alpha = E / (dt v^2), up to the largest useful damper: a step of the
/// device's resolution must not make a force above the detection threshold.
///
/// Shaking that continues lowers the force (softening()): the quick account's excess over 0.3 mJ is booked
/// as E_shaken, 5 mW at most, and forgotten within about 10 s.
///
///     F *= 1 / (1 + E_shaken / 1 mJ)
///
/// A force that is known to be shown T late may push where the hand presses no more, and so may the damper's. In that
/// time it can give the hand F T (v + F T / 2 m) at most, m being the lightest handle. No more force is shown than the
/// hand has paid for: that energy stays below what the whole account has left, and half a millijoule of credit.
///
///     F <= m / T (sqrt(v^2 + 2 (0.5 mJ - E) / m) - v)
///
/// At an unknown delay such a limit would weaken the first touch of every device. There a force is reduced only while
/// the handle jumps along it, as it does when a hand releases it: u is its velocity above 6 Hz along the force, s the
/// standard deviation of noise. u is the mean of three ticks, without the dead band, which would hide the first 3 ms of
/// a jump; one step of the device alone is no jump. B is the time of reduced force, each tick weighted by the
/// lost fraction, and is forgotten within about 5 s: a strong damper that is late would keep a handle shaking.
///
///     |F| -= (u - 0.01 m/s - s / dt) (1 - B / 30 ms) 25 N s/m
///
/// Functions may be called in the tick.
class Passivity {
 public:
  Passivity(const PassivityParameters& parameters, double tick_s) noexcept;

  /// Accounts for the time since the last call, during which `sent` was sent.
  void observe(const Pose& device, const Wrench& sent) noexcept;

  /// Wrench of the damper, to be added to the one for the device, device frame: zero while no energy is in excess.
  [[nodiscard]] Wrench damping() const noexcept;

  /// The share of the wrench that is left to a hand that has been shaken, 0 to 1.
  [[nodiscard]] double softening() const noexcept;

  /// Returns the fraction of this wrench to send, 0 to 1: what the hand has paid for, or at an unknown delay what a
  /// jumping handle is left; 1 for a device that shows it at once.
  [[nodiscard]] double affordable(const Wrench& wrench) noexcept;

  /// Forgets where the device was, how it moved and what was sent, but not what has been dissipated, nor how it shook:
  /// it is somewhere else, or has not been looked at for a while.
  void restart() noexcept;

  [[nodiscard]] double injected() const noexcept;       ///< J, whole account
  [[nodiscard]] double quickInjected() const noexcept;  ///< J, quick account

 private:
  /// Energy given to the hand, if forces act a number of ticks after they are sent.
  struct Account {
    std::size_t delay = 0;
    QuickMovement quick_force, quick_torque;
    double whole_j = 0, quick_j = 0;
  };

  void count(Account& account) noexcept;
  [[nodiscard]] double deadBand(const Vec3& position_m) noexcept;

  PassivityParameters parameters_;
  double tick_s_, strongest_damper_n_s_m_;
  bool known_ = false;
  Pose last_;                                                               ///< behind the dead band
  std::array<Vec3, 3> lately_m_{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  ///< the last movements, without a dead band
  Vec3 jump_m_s_ = Vec3::Zero();
  Twist twist_, quick_twist_;
  QuickMovement quick_velocity_, quick_rotation_, quick_jump_;
  std::array<Wrench, 32> sent_;  ///< in the last ticks, round and round
  std::size_t delay_, calls_ = 0;
  std::array<Account, 6> accounts_;
  std::size_t account_count_;
  double forgiven_j_, shaken_j_ = 0;
  double braked_s_ = 0;         ///< B
  std::array<Vec3, 3> told_m_;  ///< the last positions, oldest first
  std::size_t told_ = 0;
  double noise_m2_ = 0;  ///< variance of positions about a smooth movement, along the noisiest axis
};

}  // namespace haptolith
