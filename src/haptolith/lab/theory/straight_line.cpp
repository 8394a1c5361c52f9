#include "haptolith/lab/theory/straight_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "haptolith/core/error.h"

namespace haptolith {

StraightLine fitStraightLine(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size() || x.size() < 3) {
    throw InvalidParameter("points of a straight line", fmt::format("{} x and {} y", x.size(), y.size()),
                           "3 or more of both, to have a standard error");
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    requireInRange("x of a straight line", x[i], {});
    requireInRange("y of a straight line", y[i], {});
  }
  if (std::ranges::all_of(x, [&](double value) { return value == x.front(); })) {
    throw InvalidParameter("x of a straight line", fmt::format("{} for all points", x.front()), "two values or more");
  }

  const auto n = double(x.size());
  const double x_mean = std::reduce(x.begin(), x.end()) / n;
  const double y_mean = std::reduce(y.begin(), y.end()) / n;
  double s_xx = 0;
  double s_xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    s_xx += (x[i] - x_mean) * (x[i] - x_mean);
    s_xy += (x[i] - x_mean) * (y[i] - y_mean);
  }

  StraightLine line;
  line.slope = s_xy / s_xx;
  line.intercept = y_mean - line.slope * x_mean;
  double squares = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    squares += (y[i] - line.at(x[i])) * (y[i] - line.at(x[i]));
  }
  line.residual_sd = std::sqrt(squares / (n - 2));
  line.slope_se = line.residual_sd / std::sqrt(s_xx);
  line.intercept_se = line.residual_sd * std::sqrt(1 / n + x_mean * x_mean / s_xx);
  return line;
}

}  // namespace haptolith
