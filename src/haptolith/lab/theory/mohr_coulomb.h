#pragma once

#include <span>

namespace haptolith {

/// One specimen of a shear test, at failure.
struct ShearPoint {
  double normal_stress_pa = 0;  ///< sigma, compression > 0; 0 or more
  double shear_stress_pa = 0;   ///< tau; 0 or more
};

/// Strength of a soil by Mohr and Coulomb, with standard errors from the scatter of the specimens.
struct MohrCoulomb {
  double friction_angle_rad = 0;
  double cohesion_pa = 0;
  double friction_angle_se_rad = 0;
  double cohesion_se_pa = 0;
};

/// Friction angle (rad) and cohesion (Pa) of the straight line through the failure points of shear tests.
///
///     tau = c + sigma tan(phi)                              (Coulomb 1776)
///
/// Ordinary least squares with every specimen counting the same, as a soil laboratory draws the line. To weight with
/// 1/tau instead would hold the errors of strong specimens for larger in proportion, and let the weakest one alone
/// decide the cohesion. The standard error of phi is that of the slope times cos^2(phi).
///
/// Nothing is cut off: scatter can make the cohesion of a sand negative, and the standard error then says how much that
/// means.
/// @param points  three or more, not all at one normal stress.
/// @throws InvalidParameter otherwise. Not for the tick.
[[nodiscard]] MohrCoulomb fitMohrCoulomb(std::span<const ShearPoint> points);

}  // namespace haptolith
