#include "haptolith/soil/soil_parameters.h"

#include <cmath>

#include "haptolith/core/error.h"

namespace haptolith {

void validate(const SoilParameters& soil) {
  constexpr double kInfinity = Range{}.highest;
  requireInRange("radius_m", soil.radius_m, {1e-5, 1.0});
  requireInRange("gamma_nm", soil.gamma_nm, {0, kInfinity, Ends::kOpen});
  requireInRange("rho0_kg_m3", soil.rho0_kg_m3, {0, 1e5, Ends::kOpenBelow});
  // Any rho_max above rho0 puts a_min (paper 8) between 2R/sqrt(3) and 2R, which is a valid law.
  requireInRange("rho_max_kg_m3", soil.rho_max_kg_m3, {soil.rho0_kg_m3, 1e6, Ends::kOpenBelow});
  requireInRange("mu_hat", soil.mu_hat, {0, 10});
  if (!(std::isinf(soil.stiffness_n_m) && soil.stiffness_n_m > 0)) {
    requireInRange("stiffness_n_m", soil.stiffness_n_m, {0, kInfinity, Ends::kOpen});
  }
  requireInRange("attraction_ratio", soil.attraction_ratio, {1, 2});
  requireInRange("moving_friction_ratio", soil.moving_friction_ratio, {0, 1});
  requireInRange("contact_friction", soil.contact_friction, {0, 10});
  requireInRange("contact_cohesion_n", soil.contact_cohesion_n, {0, 1e6});
  requireInRange("cohesion_range_ratio", soil.cohesion_range_ratio, {0.001, 0.5});
  requireInRange("tangential_ratio", soil.tangential_ratio, {0.01, 1});
  requireInRange("size_spread", soil.size_spread, {0, 0.3});
  requireInRange("damping_ratio", soil.damping_ratio, {0, 0.5});
}

double macroparticleMass(const SoilParameters& soil) {
  return 4 * std::sqrt(2.0) * soil.rho0_kg_m3 * std::pow(soil.radius_m, 3);
}

SoilParameters rescaled(SoilParameters soil, double radius_m) {
  const double scale = radius_m / soil.radius_m;
  soil.radius_m = radius_m;
  soil.gamma_nm *= scale * scale * scale;
  soil.stiffness_n_m *= scale;
  soil.contact_cohesion_n *= scale * scale;
  return soil;
}

}  // namespace haptolith
