#pragma once

#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// Lunar contacts (docs/reference/soils.md) with another friction and cohesion, particles of R = 7 mm.
inline SoilParameters testSoil(double contact_friction, double contact_cohesion_n) {
  SoilParameters soil;
  soil.gamma_nm = 6e-5;
  soil.rho0_kg_m3 = 1430;
  soil.rho_max_kg_m3 = 1840;
  soil.stiffness_n_m = 3000;
  soil.friction = FrictionModel::kContact;
  soil.contact_friction = contact_friction;
  soil.contact_cohesion_n = contact_cohesion_n;
  soil.size_spread = 0.15;
  return soil;
}

}  // namespace haptolith
