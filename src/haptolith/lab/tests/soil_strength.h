#pragma once

#include <vector>

#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/lab/theory/mohr_coulomb.h"

namespace haptolith {

// Strength of a soil for equations, from simulated shear tests. For particles without cohesion the strength has none
// either: the cohesion of a fitted line would be scatter, so the line goes through the origin.

/// Returns the strength at first failure: the peak of dense soil. Loose soil has none and is sheared to the residual
/// state. Friction angle in rad.
/// @param normal_stresses_pa  stresses in the application of the equations; three or more.
/// @throws as shearTest(). Not for the tick.
[[nodiscard]] MohrCoulomb undisturbedStrength(const LabConditions& conditions, Preparation preparation,
                                              const std::vector<double>& normal_stresses_pa);

/// Strengths of dense soil before and after shearing.
struct DenseStrength {
  MohrCoulomb undisturbed, residual;
};

/// Returns both strengths of dense soil from one series of tests, sheared by `strain`; the residual state begins at 2.
/// @throws as shearTest(). Not for the tick.
[[nodiscard]] DenseStrength denseStrength(const LabConditions& conditions,
                                          const std::vector<double>& normal_stresses_pa, double strain);

/// Stiffness of dense soil before it fails.
struct SoilRigidity {
  double shear_modulus_pa = 0;  ///< G
  double volume_strain = 0;     ///< decrease of volume until the peak, over the initial volume
};

/// Simulates a shear test under one normal stress. @throws as shearUnder(), and Failure if the specimen has no modulus.
/// Not for the tick.
[[nodiscard]] SoilRigidity denseRigidity(const LabConditions& conditions, double normal_stress_pa);

/// Returns the residual strength after shearing by `strain`; the residual state begins at 2.
/// @throws as shearTest(). Not for the tick.
[[nodiscard]] MohrCoulomb residualStrength(const LabConditions& conditions,
                                           const std::vector<double>& normal_stresses_pa, double strain);

}  // namespace haptolith
