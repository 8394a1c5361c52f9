#include "haptolith/lab/tests/soil_strength.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "haptolith/core/error.h"
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

// The maximum of a scattering stress grows with strain, so the peak has a short test.
constexpr double kPeakUntil = 1;

}  // namespace

DenseStrength denseStrength(const LabConditions& conditions, const std::vector<double>& normal_stresses_pa,
                            double strain) {
  const ShearResult shear =
      shearTest(conditions, {.normal_stresses_pa = normal_stresses_pa, .strain = strain, .peak_until = kPeakUntil});
  return {.undisturbed = lineOf(conditions.soil, shear, shear.peak, &ShearPointResult::peak_pa),
          .residual = lineOf(conditions.soil, shear, shear.residual, &ShearPointResult::residual_pa)};
}

MohrCoulomb undisturbedStrength(const LabConditions& conditions, Preparation preparation,
                                const std::vector<double>& normal_stresses_pa) {
  if (preparation != Preparation::kDense) {
    return residualStrength(conditions, normal_stresses_pa, ShearOptions{}.strain);
  }
  const ShearResult shear =
      shearTest(conditions, {.normal_stresses_pa = normal_stresses_pa, .strain = kPeakUntil, .residual_from = 0.9});
  return lineOf(conditions.soil, shear, shear.peak, &ShearPointResult::peak_pa);
}

SoilRigidity denseRigidity(const LabConditions& conditions, double normal_stress_pa) {
  constexpr double kQuick = 0.06;  // inertial number: raises the strength by a few per cent, in a third of the time
  const ShearPointResult shear =
      shearUnder(conditions, {.strain = kPeakUntil, .residual_from = 0.9, .inertial_number = kQuick}, normal_stress_pa);
  if (!(shear.modulus_pa > 0) || !std::isfinite(shear.modulus_pa)) {
    throw Failure(fmt::format("soil under {:.3g} Pa has no shear modulus: its stress does not rise", normal_stress_pa));
  }
  return {.shear_modulus_pa = shear.modulus_pa, .volume_strain = std::max(0.0, shear.compression)};
}

MohrCoulomb residualStrength(const LabConditions& conditions, const std::vector<double>& normal_stresses_pa,
                             double strain) {
  const ShearResult shear = shearTest(conditions, {.normal_stresses_pa = normal_stresses_pa, .strain = strain});
  return lineOf(conditions.soil, shear, shear.residual, &ShearPointResult::residual_pa);
}

}  // namespace haptolith
