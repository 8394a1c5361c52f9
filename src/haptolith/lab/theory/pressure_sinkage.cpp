#include "haptolith/lab/theory/pressure_sinkage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "haptolith/core/error.h"
#include "haptolith/lab/theory/minimum.h"

namespace haptolith {

namespace {

// Soils have n from 0 to about 2.
constexpr double kLeastExponent = 0.05;
constexpr double kMostExponent = 5;

struct Fit {
  double scale = 0;  ///< pressure at the deepest reading
  double squares = 0;
};

/// Returns the best curve with a given exponent. Sinkage is in units of the deepest one, so that no power is tiny.
Fit fitWithExponent(std::span<const SinkagePoint> points, double deepest_m, double exponent) {
  double s_zp = 0;
  double s_zz = 0;
  for (const SinkagePoint& point : points) {
    const double power = std::pow(point.sinkage_m / deepest_m, exponent);
    s_zp += power * point.pressure_pa;
    s_zz += power * power;
  }
  Fit fit{.scale = s_zp / s_zz};
  for (const SinkagePoint& point : points) {
    const double missed = point.pressure_pa - fit.scale * std::pow(point.sinkage_m / deepest_m, exponent);
    fit.squares += missed * missed;
  }
  return fit;
}

/// Checks that a curve can be fitted to the points; returns their deepest sinkage.
double checkedDepth(std::span<const SinkagePoint> points) {
  double deepest = 0;
  for (const SinkagePoint& point : points) {
    deepest = std::max(deepest, requireInRange("sinkage_m", point.sinkage_m, {0, Range{}.highest}));
    requireInRange("pressure_pa", point.pressure_pa, {});
  }
  const bool two_depths = std::ranges::any_of(
      points, [&](const SinkagePoint& point) { return point.sinkage_m > 0 && point.sinkage_m < deepest; });
  if (points.size() < 3 || !two_depths) {
    throw InvalidParameter("readings of a plate", fmt::format("{} down to {} m", points.size(), deepest),
                           "3 or more, at two or more sinkages above 0");
  }
  return deepest;
}

}  // namespace

double PressureSinkage::pressureAt(double sinkage_m) const {
  return modulus * std::pow(requireInRange("sinkage_m", sinkage_m, {0, Range{}.highest}), exponent);
}

PressureSinkage fitPressureSinkage(std::span<const SinkagePoint> points) {
  const double deepest = checkedDepth(points);
  PressureSinkage curve;
  curve.exponent = minimumBetween(kLeastExponent, kMostExponent,
                                  [&](double exponent) { return fitWithExponent(points, deepest, exponent).squares; });
  const Fit fit = fitWithExponent(points, deepest, curve.exponent);
  constexpr double kAtTheEnd = 1e-3;
  if (fit.scale <= 0 || curve.exponent < kLeastExponent + kAtTheEnd || curve.exponent > kMostExponent - kAtTheEnd) {
    throw Failure(fmt::format("the plate's {} readings do not grow with a power of sinkage from {} to {}",
                              points.size(), kLeastExponent, kMostExponent));
  }
  curve.modulus = fit.scale / std::pow(deepest, curve.exponent);
  curve.residual_rms_pa = std::sqrt(fit.squares / double(points.size()));
  return curve;
}

}  // namespace haptolith
