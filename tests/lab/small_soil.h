// Soils coarse enough for a test of the laboratory to take a second or two.
#pragma once

#include <cmath>

#include "haptolith/lab/laboratory.h"

namespace haptolith {

/// Sand of `radius_m` on Earth, its contacts linear springs of 3000 N/m for particles of 7 mm.
inline LabConditions coarseSand(double radius_m) {
  LabConditions conditions;
  SoilParameters& soil = conditions.soil;
  soil.friction = FrictionModel::kContact;
  soil.contact_friction = 0.4;
  soil.size_spread = 0.15;
  soil.stiffness_n_m = 3000;
  const double compaction = soil.rho0_kg_m3 / soil.rho_max_kg_m3;
  const double a_min = 2 * soil.radius_m * std::sqrt((2 * compaction * compaction + 1) / 3);
  soil.gamma_nm = soil.stiffness_n_m * std::pow(2 * soil.radius_m - a_min, 2);
  soil = rescaled(soil, radius_m);
  conditions.gravity_m_s2 = 9.807;
  return conditions;
}

}  // namespace haptolith
