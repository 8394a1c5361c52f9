#pragma once

#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Whether a hand could have moved as its device reports. It could not when
///   - it moves or turns faster than any hand (10 m/s; 100 rad/s, as a hand of 0.1 m about its wrist), by its velocity
///   or
///     from one tick to the next;
///   - its velocity jumps by more than 3 m/s (30 rad/s) in a tick;
///   - velocity and pose contradict each other: the way that the velocity has promised and the way that was made differ
///   by
///     more than 4 cm (0.4 rad). That is forgotten within 0.1 s, so a constant contradiction of 0.4 m/s (4 rad/s)
///     shows.
///
/// All that devices rightly do stays well below: noise of 0.1 mm and steps of 0.06 mm are 0.2 m/s from one tick to the
/// next. A device whose packets are late, by up to 20 ms, repeats an old velocity and then covers the distance
/// in one step: that matches its velocity, and is not a jump. A velocity of exactly zero promises
/// nothing: some devices know none. Functions may be called in the tick.
class Plausibility {
 public:
  /// @param rate_hz  of new readings from the device.
  Plausibility(double rate_hz, double tick_s);

  /// The next input, live and finite; whether a hand could have moved like that.
  [[nodiscard]] bool observe(const DeviceInput& input) noexcept;

  /// The hand may be anywhere at the next input.
  void restart() noexcept { known_ = false; }

 private:
  /// One for ways, in m, and one for turns, in rad.
  struct Account {
    double fastest = 0;  ///< a second
    Vec3 velocity = Vec3::Zero();
    Vec3 promised = Vec3::Zero();  ///< by velocities, and not made yet

    [[nodiscard]] bool add(const Vec3& made, const Vec3& velocity_now, double tick_s, double step_s) noexcept;
  };

  double tick_s_, step_s_;
  bool known_ = false;
  Pose pose_;
  Account way_, turn_;
};

}  // namespace haptolith
