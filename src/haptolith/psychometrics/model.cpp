#include "haptolith/psychometrics/model.h"

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "haptolith/core/assert.h"
#include "haptolith/core/error.h"
#include "haptolith/psychometrics/likelihood.h"

namespace haptolith {

namespace {

constexpr double kMinusInfinity = -std::numeric_limits<double>::infinity();
constexpr double kMostAsymptote = 0.5;
// With eta = 1 all responses to a stimulus would be equal for any function.
constexpr double kMostOverdispersion = 1 - 1e-9;
constexpr double kBeta = 10;  // second parameter of the Beta(1, 10) priors
constexpr double kWeberBeta =
    60;  // for the rates of weber sigmoids, chosen by simulation: docs/reports/psychometric-coverage.md

/// Falls from 1 to 0 as a cosine for `share` from 0 to 1; constant elsewhere.
double cosineFall(double share) noexcept {
  return (1 + std::cos(std::numbers::pi * std::clamp(share, 0.0, 1.0))) / 2;
}

/// Returns the log density of Beta(1, beta).
double logBetaPrior(double value, double beta) noexcept {
  return std::log(beta) + (beta - 1) * std::log1p(-value);
}

void requireRate(const char* key, const std::optional<double>& value, double highest) {
  if (value) {
    requireInRange(key, *value, {0, highest});
  }
}

void requireOptions(const FitOptions& options) {
  requireInRange("confidence", options.confidence, {0, 1, Ends::kOpen});
  requireInRange("simulations", options.simulations, {.lowest = 0});
  requireInRange("alternatives", options.alternatives, {2, 1000});
  requireRate("lapse", options.lapse, kMostAsymptote);
  requireRate("guess", options.guess, kMostAsymptote);
  requireRate("overdispersion", options.overdispersion, kMostOverdispersion);
  for (const int points : {options.grid.threshold, options.grid.width, options.grid.asymptotes,
                           options.grid.overdispersion, options.grid.alone}) {
    requireInRange("points of a grid", points, {2, 10000});
  }
  if (options.guess && options.design != Design::kYesNo) {
    throw InvalidParameter("guess", fmt::format("{} with design {}", *options.guess, nameOf(options.design)),
                           "a guess rate only with design yesno; of nafc it is 1/n, else the lapse rate");
  }
}

}  // namespace

Model::Model(std::span<const Level> levels, const FitOptions& options)
    : levels_(pooled(levels)), options_(options), log_axis_(options.log_axis || isAlwaysLogarithmic(options.sigmoid)) {
  requireOptions(options);
  setAxis();
  setSupports();
  normaliseWidthPrior();
}

void Model::setAxis() {
  if (levels_.empty()) {
    throw InvalidParameter("levels", "none with a response", "one or more");
  }
  const Range logarithmic{kLeastStimulus, kMostStimulus};
  std::vector<double> places;
  for (const Level& level : levels_) {
    if (log_axis_) {
      requireInRange("x on a logarithmic axis", level.x, logarithmic);
    }
    places.push_back(log_axis_ ? std::log(level.x) : level.x);
  }
  if (options_.threshold) {
    requireInRange("threshold", *options_.threshold, log_axis_ ? logarithmic : Range{-kMostStimulus, kMostStimulus});
    places.push_back(log_axis_ ? std::log(*options_.threshold) : *options_.threshold);
  }
  std::ranges::sort(places);
  first_ = places.front();
  last_ = places.back();
  least_distance_ = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < places.size(); ++i) {
    if (places[i] > places[i - 1]) {
      least_distance_ = std::min(least_distance_, places[i] - places[i - 1]);
    }
  }
  if (last_ == first_) {
    throw InvalidParameter("levels", fmt::format("all responses at x = {}", levels_.front().x),
                           "two or more stimuli, or one in addition to the fixed threshold");
  }
  if (last_ - first_ < kLeastStimulus) {
    throw InvalidParameter("levels", fmt::format("stimuli within {:g} of each other", last_ - first_),
                           fmt::format("stimuli that reach over {:g} or more", kLeastStimulus));
  }
}

void Model::setSupports() {
  const double range = last_ - first_;
  const auto fixed = [](double value) { return Support{value, value}; };
  if (options_.threshold) {
    supports_[kThreshold] = fixed(log_axis_ ? std::log(*options_.threshold) : *options_.threshold);
  } else {
    supports_[kThreshold] = {first_ - range / 2, last_ + range / 2};
  }
  supports_[kScale] = {least_distance_, 3 * range};
  if (isWeber(options_.sigmoid)) {
    supports_[kScale] = {weberParameter(Sigmoid::kWeber, least_distance_ / 4),
                         weberParameter(Sigmoid::kWeber, 3 * range)};
  }
  supports_[kLapse] = options_.lapse ? fixed(*options_.lapse) : Support{0, kMostAsymptote};
  supports_[kGuess] = options_.guess ? fixed(*options_.guess) : Support{0, kMostAsymptote};
  if (options_.design != Design::kYesNo) {
    supports_[kGuess] = fixed(1.0 / options_.alternatives);  // unused if it is the lapse rate
  }
  supports_[kOverdispersion] =
      options_.overdispersion ? fixed(*options_.overdispersion) : Support{0, kMostOverdispersion};
}

double Model::widthPriorShape(double width) const noexcept {
  const double range = last_ - first_;
  const double rise = 1 - cosineFall((width - least_distance_) / least_distance_);
  const double fall = cosineFall((width - range) / (2 * range));
  return rise * fall;
}

void Model::normaliseWidthPrior() {
  const auto shape = [this](double width) { return widthPriorShape(width); };
  using Quadrature = boost::math::quadrature::gauss_kronrod<double, 31>;
  width_prior_integral_ = Quadrature::integrate(shape, least_distance_, 3 * (last_ - first_), 8, 1e-9);
}

int Model::freeParameters() const noexcept {
  return static_cast<int>(std::ranges::count_if(supports_, [](const Support& it) { return !it.isFixed(); }));
}

double Model::widthOf(double scale) const noexcept {
  return isWeber(options_.sigmoid) ? weberWidth(Sigmoid::kWeber, scale) : scale;
}

double Model::scaleOf(double width) const noexcept {
  return isWeber(options_.sigmoid) ? weberParameter(Sigmoid::kWeber, width) : width;
}

double Model::guessAt(const ParameterPoint& point) const noexcept {
  return options_.design == Design::kEqualAsymptote ? point[kLapse] : point[kGuess];
}

PsychometricFunction Model::functionAt(const ParameterPoint& point) const noexcept {
  PsychometricFunction function{.sigmoid = options_.sigmoid, .log_axis = log_axis_, .falling = options_.falling};
  function.threshold = fromAxis(function, point[kThreshold]);
  function.width = widthOf(point[kScale]);
  function.guess = guessAt(point);
  function.lapse = point[kLapse];
  return function;
}

double Model::logPrior(int parameter, double value) const noexcept {
  HAPTO_ASSERT(parameter >= 0 && parameter < kParameters);
  const Support& support = supports_[parameter];
  if (support.isFixed()) {
    return 0;
  }
  if (!(support.low <= value && value <= support.high)) {
    return kMinusInfinity;
  }
  if (flat_[parameter]) {
    return 0;
  }
  if (parameter == kThreshold) {
    const double range = last_ - first_;
    const double outside = std::max({first_ - value, value - last_, 0.0});
    return std::log(cosineFall(outside / (range / 2)) / (1.5 * range));
  }
  if (parameter == kScale) {
    return isWeber(options_.sigmoid) ? -2 * std::log(value) - std::log(1 / support.low - 1 / support.high)
                                     : std::log(widthPriorShape(value) / width_prior_integral_);
  }
  const bool of_weber = isWeber(options_.sigmoid) && parameter != kOverdispersion;
  return logBetaPrior(value, of_weber ? kWeberBeta : kBeta);
}

double Model::logPrior(const ParameterPoint& point) const noexcept {
  double sum = 0;
  for (int i = 0; i < kParameters; ++i) {
    sum += logPrior(i, point[i]);
  }
  return sum;
}

double Model::logLikelihood(const ParameterPoint& point) const noexcept {
  return haptolith::logLikelihood(levels_, functionAt(point), point[kOverdispersion]);
}

Model Model::withFlatPrior(int parameter, const Support& support) const {
  Model result = *this;
  result.flat_[parameter] = true;
  result.supports_[parameter] = support;
  return result;
}

Model Model::withAnswers(std::vector<Level> levels) const {
  Model result = *this;
  result.levels_ = std::move(levels);
  return result;
}

}  // namespace haptolith
