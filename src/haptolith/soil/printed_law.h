#pragma once

#include <cmath>

#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// F(a) in N (paper 19) with its three cases as they are printed, in double precision: a version of contactForce() that
/// shares nothing with it. Not for the tick.
[[nodiscard]] inline double printedForce(const SoilParameters& soil, double a) {
  const double r = soil.radius_m;
  const double ratio = soil.rho0_kg_m3 / soil.rho_max_kg_m3;
  const double a_min = std::sqrt(8.0 / 3 * r * r * ratio * ratio + 4.0 / 3 * r * r);
  const double a_thr = a_min + std::sqrt(soil.gamma_nm / soil.stiffness_n_m);
  const auto hyperbola = [&](double x) { return soil.gamma_nm / (x - a_min) - soil.gamma_nm / (2 * r - a_min); };
  if (a >= 2 * r * soil.attraction_ratio) {
    return 0;
  }
  return a >= a_thr ? hyperbola(a) : soil.stiffness_n_m * a_thr + hyperbola(a_thr) - soil.stiffness_n_m * a;
}

}  // namespace haptolith
