#include "handle.h"

namespace hand_in_the_loop {

namespace {

constexpr double kStopStiffness_n_m = 2000, kStopDamping_n_s_m = 20;

}  // namespace

void Handle::step(double dt_s, const Vec3& shown_n, const Hand& hand, const Wanted& wanted, double weight_n) {
  const Vec3 from_m = position_m_;
  const Vec3 middle_m = from_m + dt_s / 2 * velocity_m_s_;

  // The stop acts only outside the workspace, and damps both directions there.
  const Vec3 out_m = middle_m - home_m_;
  const double beyond_m = length(out_m) - parameters_.reach_m;
  const Vec3 stop_n = beyond_m > 0 ? -kStopStiffness_n_m * beyond_m / length(out_m) * out_m : Vec3{};
  const double stop_damping = beyond_m > 0 ? kStopDamping_n_s_m : 0;

  // Dampers use the mean of the velocities before and after the step, so that they cannot generate energy.
  const double damping = hand.damping_n_s_m + parameters_.damping_n_s_m + stop_damping;
  const Vec3 steady_n = shown_n + hand.stiffness_n_m * (wanted.position_m - middle_m) +
                        hand.damping_n_s_m * wanted.velocity_m_s + stop_n + Vec3{0, 0, -weight_n};
  const double half = dt_s / 2 * damping / parameters_.mass_kg;
  const Vec3 before_m_s = velocity_m_s_;
  velocity_m_s_ = 1 / (1 + half) * ((1 - half) * before_m_s + dt_s / parameters_.mass_kg * steady_n);
  position_m_ = middle_m + dt_s / 2 * velocity_m_s_;

  const Vec3 way_m = position_m_ - from_m;
  const Vec3 mean_m_s = 0.5 * (before_m_s + velocity_m_s_);
  ledger_.device_j += dot(shown_n, way_m);
  ledger_.hand_j +=
      dot(hand.stiffness_n_m * (wanted.position_m - middle_m) + hand.damping_n_s_m * (wanted.velocity_m_s - mean_m_s),
          way_m);
  ledger_.damping_j -= parameters_.damping_n_s_m * dot(mean_m_s, way_m);
  ledger_.weight_j -= weight_n * way_m.z;
  ledger_.stops_j += dot(stop_n - stop_damping * mean_m_s, way_m);
}

}  // namespace hand_in_the_loop
