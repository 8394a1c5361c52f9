#pragma once

#include <span>

namespace haptolith {

/// Stresses on one specimen of a shear test at failure.
struct ShearPoint {
  double normal_stress_pa = 0;  ///< sigma, compression > 0; 0 or more
  double shear_stress_pa = 0;   ///< tau; 0 or more
};

/// Mohr-Coulomb strength of a soil, with standard errors from the scatter of the specimens.
struct MohrCoulomb {
  double friction_angle_rad = 0;
  double cohesion_pa = 0;
  double friction_angle_se_rad = 0;
  double cohesion_se_pa = 0;
};

/// Fits friction angle (rad) and cohesion (Pa) to the failure points of shear tests.
///
///     tau = c + sigma tan(phi)                              (Coulomb 1776)
///
/// Ordinary least squares with equal weights, as in a soil laboratory. Weights of 1/tau would assume errors in
/// proportion to strength, and the weakest specimen alone would determine the cohesion. The standard error of phi is
/// that of the slope times cos^2(phi).
///
/// Values are not clamped: scatter can make the cohesion of a sand negative; the standard error shows its significance.
/// @param points  three or more, not all at one normal stress.
/// @throws InvalidParameter otherwise. Not for the tick.
[[nodiscard]] MohrCoulomb fitMohrCoulomb(std::span<const ShearPoint> points);

}  // namespace haptolith
