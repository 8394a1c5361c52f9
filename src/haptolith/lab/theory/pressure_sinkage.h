#pragma once

#include <span>

namespace haptolith {

/// Reading of a plate that is pushed into soil.
struct SinkagePoint {
  double sinkage_m = 0;    ///< z, below the undisturbed surface; 0 or more
  double pressure_pa = 0;  ///< p, force over the plate's area
};

/// Pressure-sinkage curve with its residual.
struct PressureSinkage {
  double modulus = 0;          ///< k, in Pa/m^n: the pressure at 1 m of sinkage
  double exponent = 0;         ///< n
  double residual_rms_pa = 0;  ///< root mean square of the residuals

  /// Returns p = k z^n in Pa, at a sinkage in m.
  [[nodiscard]] double pressureAt(double sinkage_m) const;
};

/// Fits modulus and exponent of the curve to a plate's readings.
///
///     p = k z^n                                             (Bernstein 1913, Goriatchkin 1936; Bekker 1956)
///
/// Least squares in p. The common straight line through (ln z, ln p) gives a different curve, because the first tenths
/// of a millimetre, with an uncertain zero of sinkage, have as much weight as all the rest. For a given n the best k is
/// in closed form, so one search over n finds both.
///
/// k and n are correlated: for z far below 1 m, a slightly larger n implies a much larger k. Compare curves by
/// pressureAt(), not by k alone.
/// @param points  three or more, at two or more sinkages above 0; pressures may be slightly negative, as readings are.
/// @throws InvalidParameter otherwise; Failure when the best n is not inside 0.05 to 5: such readings are no power law.
/// Not for the tick.
[[nodiscard]] PressureSinkage fitPressureSinkage(std::span<const SinkagePoint> points);

}  // namespace haptolith
