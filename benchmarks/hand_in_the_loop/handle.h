#pragma once

#include "vec.h"

namespace hand_in_the_loop {

/// Grip on the handle: a spring and a damper to the person's target position. Both 0: released.
struct Hand {
  double stiffness_n_m = 0, damping_n_s_m = 0;
};

/// Target of the person for the handle.
struct Wanted {
  Vec3 position_m, velocity_m_s;
};

/// Work done on the handle since the start, J.
struct Ledger {
  double device_j = 0;  ///< by the rendered force
  double hand_j = 0;
  double damping_j = 0;  ///< by the device's damping; never > 0
  double weight_j = 0;
  double stops_j = 0;  ///< by the ends of the device's workspace
};

struct HandleParameters {
  double mass_kg = 0.1;
  double damping_n_s_m = 0;  ///< the device's damping
  /// Half the size of the device's workspace around the handle's initial position; beyond it a stop pushes back.
  double reach_m = 0.15;
};

/// Point mass, moved by a hand, a device and its weight.
class Handle {
 public:
  Handle(const HandleParameters& parameters, const Vec3& position_m)
      : parameters_(parameters), home_m_(position_m), position_m_(position_m) {}

  /// Integrates one step: half a drift, a kick, half a drift. The step is symplectic, and the change of kinetic energy
  /// is exactly the sum of force times displacement.
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
