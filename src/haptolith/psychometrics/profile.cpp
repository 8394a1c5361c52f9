#include "haptolith/psychometrics/profile.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/stop_asked.h"

namespace haptolith {

namespace {

constexpr int kScanned = 10;             // number of values between the best one and the end of the support
constexpr int kHalvings = 8;             // number of bisections between two of them
constexpr double kFar = 1000;            // search limit of an unbounded quantity, in units of its best value
constexpr double kFirstDistance = 1e-3;  // fraction of the distance to the end of the support
constexpr double kLeastDistance = 1e-9;  // fraction as above; less than the interval of a billion responses
constexpr double kCloser = 4;            // factor of a shorter distance
constexpr double kToleranceOfDistance = 0.1;
constexpr double kRough = 1e-4;  // tolerance of a search for a range that may be too wide

}  // namespace

/// Quantity of a profile.
struct Profile::Quantity {
  Parameter pinned = kThreshold;
  bool logarithmic = false;  ///< whether values are spaced logarithmically from the best one to the end of the support
  double tolerance = 1e-7;   ///< tolerance of searches
  /// Returns the value of the pinned parameter for a value of the quantity, with the other parameters of the point.
  std::function<double(const ParameterPoint&, double)> pinned_value = [](const ParameterPoint&, double value) {
    return value;
  };

  /// Returns the value at a fraction of the distance from `best` to `bound`.
  [[nodiscard]] double between(double best, double bound, double share) const {
    return logarithmic ? best * std::pow(bound / best, share) : best + (bound - best) * share;
  }
};

Profile::Profile(const Model& model, Objective objective, const Optimum& best, double depth,
                 std::vector<ParameterPoint> starts)
    : model_(model), objective_(objective), best_(best), depth_(depth), starts_(std::move(starts)) {
  starts_.push_back(best.point);
}

Interval Profile::of(Parameter parameter) const {
  const double best = best_.point[parameter];
  const Support& support = model_.support(parameter);
  if (support.isFixed()) {
    return {best, best};
  }
  const Quantity quantity{.pinned = parameter, .logarithmic = parameter == kScale};
  return {end(quantity, best, support.low), end(quantity, best, support.high)};
}

Interval Profile::of(Derived derived) const {
  const double best = derived(model_.functionAt(best_.point));
  if (!(best > 0)) {
    return {};  // a Weber fraction at a threshold below 0
  }
  const auto scale = [this, derived](const ParameterPoint& point, double value) {
    const PsychometricFunction function = model_.functionAt(point);
    const double jnd = derived == jndOf ? value : value * function.threshold;
    const double distance = toAxis(function, function.threshold + jnd) - toAxis(function, function.threshold);
    return model_.scaleOf(distance / jndInWidths(function));
  };
  const Quantity quantity{.pinned = kScale, .logarithmic = true, .pinned_value = scale};
  const Interval interval{end(quantity, best, best / kFar), end(quantity, best, best * kFar)};
  return {interval.low > best / kFar ? interval.low : 0,
          interval.high < best * kFar ? interval.high : std::numeric_limits<double>::infinity()};
}

Support Profile::around(Parameter parameter) const {
  const double best = best_.point[parameter];
  const Support& support = model_.support(parameter);
  if (support.isFixed()) {
    return support;
  }
  const Quantity quantity{.pinned = parameter, .logarithmic = parameter == kScale, .tolerance = kRough};
  return {endBeyond(quantity, best, support.low), endBeyond(quantity, best, support.high)};
}

/// Returns the farthest value from the best one towards `bound` that is near enough.
double Profile::end(const Quantity& quantity, double best, double bound) const {
  if (best == bound) {
    return bound;
  }
  std::vector<ParameterPoint> starts = starts_;
  const auto is_near = [&](double share) { return isNear(quantity, quantity.between(best, bound, share), starts); };
  double inside = 0;
  double outside = 1;
  for (int i = 1; i <= kScanned; ++i) {
    throwIfStopped();
    const double share = double(i * i) / (kScanned * kScanned);  // denser near the best value
    if (is_near(share)) {
      inside = share;
      outside = 1;
    } else {
      outside = std::min(outside, share);
    }
  }
  if (inside == 1) {
    return bound;
  }
  starts = starts_;
  while (inside == 0 && outside > kLeastDistance) {  // very many responses have a narrow range
    const double closer = outside / kCloser;
    (is_near(closer) ? inside : outside) = closer;
  }
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (inside + outside) / 2;
    (is_near(middle) ? inside : outside) = middle;
  }
  return quantity.between(best, bound, (inside + outside) / 2);
}

/// Returns a value beyond the end, found in growing steps from the best one.
double Profile::endBeyond(const Quantity& quantity, double best, double bound) const {
  if (best == bound) {
    return bound;
  }
  std::vector<ParameterPoint> starts = starts_;
  const auto is_near = [&](double share) {
    Quantity as_exact = quantity;
    as_exact.tolerance = std::min(quantity.tolerance, share * kToleranceOfDistance);
    return isNear(as_exact, as_exact.between(best, bound, share), starts);
  };
  double share = kFirstDistance;
  bool near = is_near(share);
  while (!near && share > kLeastDistance) {  // very many responses have a narrow range
    share /= kCloser;
    near = is_near(share);
  }
  while (near && share < 1) {
    share *= 1.5;
    near = share < 1 && is_near(share);
  }
  return share < 1 ? quantity.between(best, bound, share) : bound;
}

/// Whether the best point with this value is within the depth of the maximum; adds that point to `starts`.
bool Profile::isNear(const Quantity& quantity, double value, std::vector<ParameterPoint>& starts) const {
  const Pin pin{quantity.pinned, [&](const ParameterPoint& point) { return quantity.pinned_value(point, value); }};
  const Optimum found =
      optimumNear(model_, starts, {.objective = objective_, .pin = pin, .tolerance = quantity.tolerance});
  starts.resize(starts_.size());
  starts.push_back(found.point);
  return best_.log_density - found.log_density <= depth_;
}

double confidenceDepth(const Model& model) {
  const double confidence = model.options().confidence;
  if (model.support(kOverdispersion).isFixed()) {
    return boost::math::quantile(boost::math::chi_squared(1), confidence) / 2;
  }
  const auto levels = static_cast<double>(model.levels().size());
  const double degrees = std::max(levels - (model.freeParameters() - 1), 1.0);
  const double t = boost::math::quantile(boost::math::students_t(degrees), (1 + confidence) / 2);
  return levels / 2 * std::log1p(t * t / degrees);
}

}  // namespace haptolith
