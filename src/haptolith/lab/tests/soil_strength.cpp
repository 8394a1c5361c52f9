#include "haptolith/lab/tests/soil_strength.h"

#include <cmath>

#include "haptolith/lab/tests/shear.h"

namespace haptolith {

namespace {

/// Returns the line through the strengths; for particles without cohesion the line through the origin.
MohrCoulomb lineOf(const SoilParameters& soil, const ShearResult& shear, const MohrCoulomb& fitted,
                   double ShearPointResult::*strength_pa) {
  if (soil.contact_cohesion_n > 0) {
    return fitted;
  }
  return {.friction_angle_rad = std::atan(frictionWithoutCohesion(shear.points, strength_pa)), .cohesion_pa = 0};
}

}  // namespace

MohrCoulomb undisturbedStrength(const LabConditions& conditions, Preparation preparation,
                                const std::vector<double>& normal_stresses_pa) {
  if (preparation == Preparation::kLoose) {
    return residualStrength(conditions, normal_stresses_pa, ShearOptions{}.strain);
  }
  // The maximum of a scattering stress grows with strain, so the peak has a short test.
  const ShearResult shear =
      shearTest(conditions, {.normal_stresses_pa = normal_stresses_pa, .strain = 1, .residual_from = 0.9});
  return lineOf(conditions.soil, shear, shear.peak, &ShearPointResult::peak_pa);
}

MohrCoulomb residualStrength(const LabConditions& conditions, const std::vector<double>& normal_stresses_pa,
                             double strain) {
  const ShearResult shear = shearTest(conditions, {.normal_stresses_pa = normal_stresses_pa, .strain = strain});
  return lineOf(conditions.soil, shear, shear.residual, &ShearPointResult::residual_pa);
}

}  // namespace haptolith
