#pragma once

#include <span>

namespace haptolith {

/// Depth down to which lunar bulk density was measured, in m: neither the law nor a comparison with it goes deeper.
inline constexpr double kLunarLawDepthM = 0.6;

/// Bulk density of undisturbed lunar regolith, in kg/m^3.
///
///     rho(z) = 1270 + 121 ln(100 z + 1)                  (paper 1)
///
/// The paper prints kappa = 0.121, which is the g/cm^3 value; see docs/contributing/equations.md.
/// @param depth_m  z, depth below the surface, in m; 0 <= z <= 0.6.
/// @throws InvalidParameter outside that range.
[[nodiscard]] double lunarBulkDensity(double depth_m);

/// Mean of lunarBulkDensity() over a band of depth, in kg/m^3: the integral of (paper 1), in closed form.
/// @param top_m, bottom_m  the band, in m; 0 <= top < bottom <= 0.6.
/// @throws InvalidParameter outside that range.
[[nodiscard]] double lunarMeanBulkDensity(double top_m, double bottom_m);

/// Bulk density measured on the Moon, averaged over a band of depth.
struct MeasuredBand {
  double top_m = 0;
  double bottom_m = 0;
  double density_kg_m3 = 0;
  double tolerance_kg_m3 = 0;  ///< the measurement's own uncertainty, +-
};

/// The four bands 0-15, 0-30, 30-60 and 0-60 cm: Lunar Sourcebook (Carrier, Olhoeft and Mendell 1991), as the paper's
/// Table I quotes it (its reference [11]).
[[nodiscard]] std::span<const MeasuredBand> measuredBands();

}  // namespace haptolith
