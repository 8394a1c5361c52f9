#pragma once

#include "vec.h"

namespace hand_in_the_loop {

/// What holds the handle: a spring and a damper to where the person wants it. Both 0: nobody.
struct Hand {
  double stiffness_n_m = 0, damping_n_s_m = 0;
};

/// Where the person wants the handle.
struct Wanted {
  Vec3 position_m, velocity_m_s;
};

/// Work done on the handle since the start, J.
struct Ledger {
  double device_j = 0;  ///< by the shown force
  double hand_j = 0;
  double damping_j = 0;  ///< by the device's own damping; never > 0
  double weight_j = 0;
  double stops_j = 0;  ///< by the ends of the device's workspace
};

struct HandleParameters {
  double mass_kg = 0.1;
  double damping_n_s_m = 0;  ///< the device's own
  /// Half the size of the device's workspace: beyond it from where the handle began, a stop pushes it back.
  double reach_m = 0.15;
};

/// A point mass that a hand, a device and its weight move.
class Handle {
 public:
  Handle(const HandleParameters& parameters, const Vec3& position_m)
      : parameters_(parameters), home_m_(position_m), position_m_(position_m) {}

  /// Half a way, a kick, half a way: symplectic, and the change of kinetic energy is exactly the sum of force times
  /// way.
  void step(double dt_s, const Vec3& shown_n, const Hand& hand, const Wanted& wanted, double weight_n);

  [[nodiscard]] const Vec3& position() const { return position_m_; }
  [[nodiscard]] const Vec3& velocity() const { return velocity_m_s_; }
  [[nodiscard]] const Ledger& ledger() const { return ledger_; }
  [[nodiscard]] double kineticEnergy() const { return parameters_.mass_kg / 2 * dot(velocity_m_s_, velocity_m_s_); }

 private:
  HandleParameters parameters_;
  Vec3 home_m_, position_m_, velocity_m_s_;
  Ledger ledger_;
};

}  // namespace hand_in_the_loop
