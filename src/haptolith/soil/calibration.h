#pragma once

#include <limits>

#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// Deviation of a soil's density from the lunar law over the measured depths, 0 to 0.6 m, in kg/m^3.
///
///     sqrt( sum_n h_n (rho(n) - rho_law,n)^2 / 0.6 m )
///
/// h_n is the height of layer n's share of the depth (Layer::top_m to bottom_m, the last one cut at 0.6 m), rho(n) its
/// density (paper 11) and rho_law,n the mean of the law (paper 1) over that height. Comparing means, not points, keeps
/// the stairs of thick layers out of the measure, so it means the same for every R.
/// @param soil          any valid soil; its stiffness may be infinite.
/// @param gravity_m_s2  0 to 1000.
/// @throws as layersToDepth().
[[nodiscard]] double lunarDensityRms(const SoilParameters& soil, double gravity_m_s2);

/// Properties that the calibrated soil must have.
struct CalibrationTarget {
  double friction_coefficient = 0;  ///< mu (paper 17), above 0 to 2 (63 degrees)
  double cohesion_pa = 0;           ///< C (paper 18), above 0; the most that can be reached depends on mu and k
  double gravity_m_s2 = 1.625;      ///< above 0 to 1000
  double radius_m = 7e-3;           ///< R, 0.5 to 20 mm
  /// k (paper 7) in the density analysis; infinite as in the paper. The contact law needs k > gamma / (2R - a_min)^2,
  /// which limits the cohesion; with k infinite here, the limit is taken for the paper's 100 N/m at 7 mm (k ~ R), so
  /// that the soil can be put into a bed.
  double stiffness_n_m = std::numeric_limits<double>::infinity();
};

/// A soil with the wanted friction and cohesion whose density follows the lunar law as closely as it can.
struct Calibration {
  SoilParameters soil;
  double cohesion_pa = 0;        ///< C of `soil` (paper 18)
  double density_rms_kg_m3 = 0;  ///< lunarDensityRms() of `soil`
};

/// Finds mu_hat, gamma, rho0 and rho_max for a wanted friction coefficient and cohesion.
///
/// mu_hat follows from (paper 17). (paper 18) is linear in gamma, so every pair of rho0 and rho_max has exactly one
/// gamma that meets the cohesion. Among the pairs with 1000 <= rho0 <= 1600 and rho_max <= 2600 kg/m^3 the one with the
/// least lunarDensityRms() is taken: a global search (DIRECT), then a local one. The result does not depend on chance.
/// @throws InvalidParameter for a target outside its range, and for a cohesion that no pair reaches, with the range
/// that can be reached.
[[nodiscard]] Calibration calibrate(const CalibrationTarget& target);

}  // namespace haptolith
