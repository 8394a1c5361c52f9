#pragma once

#include <span>

namespace haptolith {

/// Straight line through points, with standard errors from the points' scatter about it.
struct StraightLine {
  double intercept = 0;
  double slope = 0;
  double intercept_se = 0;
  double slope_se = 0;
  double residual_sd = 0;  ///< SD of y about the line, with n - 2 degrees of freedom

  [[nodiscard]] double at(double x) const noexcept { return intercept + slope * x; }
};

/// Fits y = intercept + slope x by ordinary least squares: x is exact, and each y has the same error. Not for the tick.
/// @param x, y  of equal length, three points or more, finite, and not all at one x.
/// @throws InvalidParameter otherwise.
[[nodiscard]] StraightLine fitStraightLine(std::span<const double> x, std::span<const double> y);

}  // namespace haptolith
