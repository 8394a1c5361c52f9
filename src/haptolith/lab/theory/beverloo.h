#pragma once

#include <span>

namespace haptolith {

/// Reduction of the effective opening, in particle diameters: Beverloo's value.
inline constexpr double kBeverlooGap = 1.4;

/// Round opening in the flat floor of a much wider container.
struct Outlet {
  double opening_m = 0;            ///< D, diameter; above k d
  double particle_diameter_m = 0;  ///< d; above 0
  double density_kg_m3 = 0;        ///< rho, bulk; above 0
  double gravity_m_s2 = 9.81;      ///< g; 0 to 1000
  double coefficient = 0.58;       ///< C, Beverloo's value; above 0 to 2; 0.55 to 0.65 for grains
  double gap = kBeverlooGap;       ///< k; 0 to 5
};

/// Returns the discharge rate of grains from a container, in kg/s.
///
///     W = C rho sqrt(g) (D - k d)^(5/2)
///
/// Beverloo, Leniger and van de Velde, The flow of granular solids through orifices (Chem. Eng. Sci. 15, 1961). It does
/// not depend on the fill height. It holds for grains without cohesion and D from about 6 d; below, they form arches
/// and stop at times.
/// @throws InvalidParameter outside the ranges above.
[[nodiscard]] double beverlooRate(const Outlet& outlet);

/// Measured discharge through one opening.
struct DischargePoint {
  double opening_m = 0;  ///< D; above k d
  double rate_kg_s = 0;  ///< W; above 0
};

/// Power law of discharge.
struct DischargeFit {
  double prefactor = 0;     ///< C', in kg/s/m^e
  double exponent = 0;      ///< e; 5/2 by Beverloo
  double exponent_se = 0;   ///< standard error, from the points' scatter, for the given k
  double gap = 0;           ///< k
  double log_residual = 0;  ///< standard deviation of ln W about the fit: 0.01 means 1 %

  /// Returns W = C' (D - k d)^e, in kg/s. @throws InvalidParameter unless D > k d.
  [[nodiscard]] double rateAt(double opening_m, double particle_diameter_m) const;
};

/// Fits exponent and prefactor of discharge through openings of several sizes, with k given.
///
///     ln W = ln C' + e ln(D - k d)
///
/// by least squares, so that errors are relative to the rate.
/// @param points  three or more, of two or more sizes, each wider than k d.
/// @param particle_diameter_m  d, above 0.
/// @param gap  k, 0 to 5.
/// @throws InvalidParameter otherwise. Not for the tick.
[[nodiscard]] DischargeFit fitDischarge(std::span<const DischargePoint> points, double particle_diameter_m,
                                        double gap = kBeverlooGap);

}  // namespace haptolith
