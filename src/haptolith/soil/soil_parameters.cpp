#include "haptolith/soil/soil_parameters.h"

#include <cmath>

#include "haptolith/core/error.h"

namespace haptolith {

void validate(const SoilParameters& soil) {
  requireInRange("radius_m", soil.radius_m, SoilRanges::radius_m);
  requireInRange("gamma_nm", soil.gamma_nm, SoilRanges::gamma_nm);
  requireInRange("rho0_kg_m3", soil.rho0_kg_m3, SoilRanges::rho0_kg_m3);
  // Any rho_max above rho0 puts a_min (paper 8) between 2R/sqrt(3) and 2R, which is a valid law.
  requireInRange("rho_max_kg_m3", soil.rho_max_kg_m3,
                 {soil.rho0_kg_m3, SoilRanges::rho_max_kg_m3.highest, Ends::kOpenBelow});
  requireInRange("mu_hat", soil.mu_hat, SoilRanges::mu_hat);
  if (!(std::isinf(soil.stiffness_n_m) && soil.stiffness_n_m > 0)) {
    requireInRange("stiffness_n_m", soil.stiffness_n_m, SoilRanges::stiffness_n_m);
  }
  requireInRange("attraction_ratio", soil.attraction_ratio, SoilRanges::attraction_ratio);
  requireInRange("moving_friction_ratio", soil.moving_friction_ratio, SoilRanges::moving_friction_ratio);
  requireInRange("contact_friction", soil.contact_friction, SoilRanges::contact_friction);
  requireInRange("contact_cohesion_n", soil.contact_cohesion_n, SoilRanges::contact_cohesion_n);
  requireInRange("cohesion_range_ratio", soil.cohesion_range_ratio, SoilRanges::cohesion_range_ratio);
  requireInRange("tangential_ratio", soil.tangential_ratio, SoilRanges::tangential_ratio);
  requireInRange("size_spread", soil.size_spread, SoilRanges::size_spread);
  requireInRange("damping_ratio", soil.damping_ratio, SoilRanges::damping_ratio);
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
