#pragma once

#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// Bulk density to which the paper compacts the soil before it shears it, rho_1 of (paper 15), in kg/m^3.
inline constexpr double kCompactedDensity = 1967;

/// Coefficient of internal friction, without unit: mu = sqrt(6) mu_hat (paper 17).
/// @param mu_hat  model friction, 0 to 10.
/// @throws InvalidParameter outside that range.
[[nodiscard]] double frictionCoefficient(double mu_hat);

/// Model friction mu_hat that gives a coefficient of internal friction, without unit; inverse of (paper 17).
/// @param friction_coefficient  mu, 0 to 24.
/// @throws InvalidParameter outside that range.
[[nodiscard]] double modelFriction(double friction_coefficient);

/// Angle of internal friction, in rad: phi = atan(mu) (paper 13).
/// @param friction_coefficient  mu, 0 or more.
/// @throws InvalidParameter when negative or not finite.
[[nodiscard]] double frictionAngle(double friction_coefficient);

/// Distance between neighbours in soil compacted evenly to rho_1 = 1967 kg/m^3, in m.
///
///     a_1 = 2R (rho0 / rho_1)^(1/3)                        (paper 15)
///
/// @throws InvalidParameter unless a_min < a_1 < 2R: rho0 must be below 1967 and above 379 kg/m^3, and rho_max above
/// leastCompactableRhoMax(rho0, 1).
[[nodiscard]] double compactedDistance(const SoilParameters& soil);

/// The rho_max for which soil compacted to rho_1 has used up a given part of the way from 2R to a_min, in kg/m^3;
/// more than that part for a smaller rho_max. From (paper 8) and (paper 15); infinite when no rho_max leaves so much.
/// @param rho0_kg_m3  379 to 1967, both excluded.
/// @param overlap     (2R - a_1) / (2R - a_min), above 0 to 1. At 1, a_1 = a_min and (paper 18) diverges.
/// @throws InvalidParameter outside these ranges.
[[nodiscard]] double leastCompactableRhoMax(double rho0_kg_m3, double overlap);

/// Cohesion as the paper predicts it from the contact law, in Pa.
///
///     C = 6 sqrt(3) mu_hat F(a_1) / a_1^2                  (paper 18)
///
/// F is the law (paper 7) with infinite k, whatever the soil's k. A bed of such particles does not show this cohesion
/// when it is sheared: see docs/contributing/equations.md.
/// @throws InvalidParameter as compactedDistance().
[[nodiscard]] double cohesion(const SoilParameters& soil);

}  // namespace haptolith
