#include "haptolith/psychometrics/fit.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/goodness_of_fit.h"
#include "haptolith/psychometrics/likelihood.h"
#include "haptolith/psychometrics/model.h"
#include "haptolith/psychometrics/optimum.h"
#include "haptolith/psychometrics/posterior.h"
#include "haptolith/psychometrics/profile.h"

namespace haptolith {

namespace {

constexpr int kDraws = 400;
constexpr double kBeyond = 1e200;  // represents infinity
constexpr int kPeaks = 8;          // number of peaks of the likelihood that the search starts from

/// Computes the estimates and statistics common to both methods.
Fit fitAt(const Model& model, const ParameterPoint& point, const ParameterPoint& most_likely,
          const SimulatedFits& simulated) {
  const FitOptions& options = model.options();
  Fit fit{.design = options.design,
          .alternatives = options.alternatives,
          .confidence = options.confidence,
          .levels = model.levels()};
  fit.function = model.functionAt(point);
  fit.threshold.value = fit.function.threshold;
  fit.width.value = fit.function.width;
  fit.jnd.value = jndOf(fit.function);
  fit.weber_fraction.value = weberFractionOf(fit.function);
  if (isWeber(options.sigmoid)) {
    fit.w = Estimate{.value = weberParameter(options.sigmoid, fit.function.width)};
  }
  fit.lapse.value = fit.function.lapse;
  fit.guess.value = fit.function.guess;
  fit.overdispersion.value = point[kOverdispersion];
  for (const Level& level : model.levels()) {
    fit.n_trials += level.n;
  }
  fit.free_parameters = model.freeParameters();
  fit.deviance = devianceOf(model.levels(), fit.function);
  fit.log_likelihood = model.logLikelihood(most_likely);
  fit.aic = 2 * fit.free_parameters - 2 * fit.log_likelihood;
  fit.bic = fit.free_parameters * std::log(fit.n_trials) - 2 * fit.log_likelihood;
  const double least_deviance = devianceOf(model.levels(), model.functionAt(most_likely));
  fit.doubt = doubtOf(model.levels(), options);
  fit.p_value = simulatedPValue(simulated, least_deviance);
  fit.p_value_chi_square = chiSquarePValue(model, least_deviance);
  return fit;
}

/// Returns the interval of a quantity of the width alone, from the ends of the width's interval.
Interval intervalByWidth(const PsychometricFunction& function, const Interval& width, Derived derived) {
  PsychometricFunction at = function;
  at.width = width.low;
  const double at_low = derived(at);
  at.width = width.high;
  const double at_high = derived(at);
  return {std::min(at_low, at_high), std::max(at_low, at_high)};
}

/// Whether a quantity depends on the threshold as well as the width: the JND on a logarithmic axis, the Weber fraction
/// on a linear one.
bool dependsOnThreshold(const Model& model, Derived derived) {
  return !model.support(kThreshold).isFixed() && (derived == jndOf) == model.isLogarithmic();
}

/// Returns the interval of a quantity of threshold and width.
Interval intervalByBoth(const Model& model, const Posterior& posterior, double confidence, Derived derived) {
  const std::size_t pairs = posterior.axes[kThreshold].values.size() * posterior.axes[kScale].values.size();
  const std::size_t block = posterior.mass.size() / pairs;  // the other parameters vary faster
  std::vector<WeightedValue> values(pairs);
  for (std::size_t pair = 0; pair < pairs; ++pair) {
    const double value = derived(model.functionAt(pointOf(posterior, pair * block)));
    values[pair].value = value > 0 ? value : kBeyond;  // a Weber fraction at a threshold of 0 or less
    for (std::size_t i = 0; i < block; ++i) {
      values[pair].mass += posterior.mass[pair * block + i];
    }
  }
  const auto [low, high] = percentileInterval(std::move(values), confidence);
  return {low, high < std::sqrt(kBeyond) ? high : std::numeric_limits<double>::infinity()};
}

/// Returns the medians of all marginals.
ParameterPoint medianOf(const Posterior& posterior) {
  ParameterPoint point;
  for (int i = 0; i < kParameters; ++i) {
    point[i] = credibleInterval(posterior, i, 0).low;
  }
  return point;
}

/// Sets the intervals of a fit.
/// @param of_parameter  returns the interval of a parameter. @param of_both  that of a quantity of threshold and width.
void setIntervals(Fit& fit, const Model& model, const std::function<Interval(Parameter)>& of_parameter,
                  const std::function<Interval(Derived)>& of_both) {
  const Interval place = of_parameter(kThreshold);
  fit.threshold.interval = {fromAxis(fit.function, place.low), fromAxis(fit.function, place.high)};
  const Interval scale = of_parameter(kScale);
  fit.width.interval = {model.widthOf(scale.low), model.widthOf(scale.high)};
  if (fit.w) {
    fit.w->interval = {weberParameter(fit.function.sigmoid, fit.width.interval.low),
                       weberParameter(fit.function.sigmoid, fit.width.interval.high)};
  }
  const auto derived_interval = [&](Derived derived) {
    return dependsOnThreshold(model, derived) ? of_both(derived)
                                              : intervalByWidth(fit.function, fit.width.interval, derived);
  };
  fit.jnd.interval = derived_interval(jndOf);
  const bool may_be_zero =
      (fit.method == FitMethod::kMaximumLikelihood ? fit.threshold.value : fit.threshold.interval.low) <= 0;
  if (may_be_zero) {
    fit.weber_fraction.value = std::numeric_limits<double>::quiet_NaN();
  } else {
    fit.weber_fraction.interval = derived_interval(weberFractionOf);
  }
  fit.lapse.interval = of_parameter(kLapse);
  fit.guess.interval = fit.design == Design::kEqualAsymptote ? fit.lapse.interval : of_parameter(kGuess);
  fit.overdispersion.interval = of_parameter(kOverdispersion);
}

}  // namespace

bool isAtEdge(const Estimate& estimate) noexcept {
  return estimate.value < estimate.interval.low || estimate.value > estimate.interval.high;
}

FitOptions weberOptions(double reference, Sigmoid sigmoid) {
  return {.sigmoid = sigmoid,
          .design = Design::kEqualAsymptote,
          .log_axis = true,
          .threshold = reference,
          .lapse = 0,
          .overdispersion = 0};
}

Fit fitPsychometric(std::span<const Level> levels, const FitOptions& options) {
  const Model model(levels, options);
  const Posterior posterior = posteriorOf(model);
  const ParameterPoint most_probable =
      optimumNear(model, {{posterior.best}}, {.objective = Objective::kPosterior}).point;
  std::vector<ParameterPoint> starts = likelihoodPeaks(model, kPeaks);
  starts.push_back(most_probable);
  const ParameterPoint most_likely = optimumNear(model, starts, {.objective = Objective::kLikelihood}).point;
  const bool median =
      options.estimate.value_or(isWeber(options.sigmoid) ? PointEstimate::kMedian : PointEstimate::kMap) ==
      PointEstimate::kMedian;
  const SimulatedFits simulated = simulatedFits(model, most_likely);
  Fit fit = fitAt(model, median ? medianOf(posterior) : most_probable, most_likely, simulated);
  fit.method = median ? FitMethod::kMedian : FitMethod::kMap;
  fit.log_evidence = posterior.log_evidence;
  setIntervals(
      fit, model, [&](Parameter parameter) { return credibleInterval(posterior, parameter, fit.confidence); },
      [&](Derived derived) { return intervalByBoth(model, posterior, fit.confidence, derived); });
  for (const ParameterPoint& point : drawsOf(posterior, kDraws)) {
    fit.draws.push_back(model.functionAt(point));
  }
  return fit;
}

Fit fitMaximumLikelihood(std::span<const Level> levels, const FitOptions& options) {
  const Model model(levels, options);
  const std::vector<ParameterPoint> peaks = likelihoodPeaks(model, kPeaks);
  const Optimum best = optimumNear(model, peaks, {.objective = Objective::kLikelihood});
  const SimulatedFits simulated = simulatedFits(model, best.point);
  Fit fit = fitAt(model, best.point, best.point, simulated);
  fit.method = FitMethod::kMaximumLikelihood;
  const Profile profile(model, Objective::kLikelihood, best, confidenceDepth(model), peaks);
  setIntervals(
      fit, model, [&](Parameter parameter) { return profile.of(parameter); },
      [&](Derived derived) { return profile.of(derived); });
  for (const ParameterPoint& point : simulated.points) {
    fit.draws.push_back(model.functionAt(point));
  }
  return fit;
}

std::vector<Interval> credibleBand(const Fit& fit, std::span<const double> xs) {
  std::vector<Interval> band;
  for (const double x : xs) {
    std::vector<WeightedValue> values;
    for (const PsychometricFunction& draw : fit.draws) {
      values.push_back({probability(draw, x), 1});
    }
    band.push_back(values.empty() ? Interval{} : percentileInterval(std::move(values), fit.confidence));
  }
  return band;
}

std::vector<Fit> compareSigmoids(std::span<const Level> levels, const FitOptions& options,
                                 std::span<const Sigmoid> sigmoids) {
  std::vector<Fit> fits;
  for (const Sigmoid sigmoid : sigmoids) {
    FitOptions of_this = options;
    of_this.sigmoid = sigmoid;
    fits.push_back(fitPsychometric(levels, of_this));
  }
  std::ranges::stable_sort(fits, std::ranges::greater{}, &Fit::log_evidence);
  return fits;
}

}  // namespace haptolith
