#include "haptolith/psychometrics/fit.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/goodness_of_fit.h"
#include "haptolith/psychometrics/likelihood.h"
#include "haptolith/psychometrics/model.h"
#include "haptolith/psychometrics/optimum.h"
#include "haptolith/psychometrics/posterior.h"

namespace haptolith {

namespace {

constexpr int kDraws = 400;

/// What the estimates and statistics of both methods have in common.
Fit fitAt(const Model& model, const ParameterPoint& point, const ParameterPoint& most_likely,
          const SimulatedFits& simulated) {
  const FitOptions& options = model.options();
  Fit fit{.design = options.design, .confidence = options.confidence, .levels = model.levels()};
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
  fit.p_value = simulatedPValue(simulated, least_deviance);
  fit.p_value_chi_square = chiSquarePValue(model, least_deviance);
  return fit;
}

/// The posterior of what depends on threshold and width alone.
Interval derivedInterval(const Model& model, const Posterior& posterior, double confidence,
                         const std::function<double(const PsychometricFunction&)>& derived) {
  const std::size_t pairs = posterior.values[kThreshold].size() * posterior.values[kScale].size();
  const std::size_t block = posterior.mass.size() / pairs;  // the other parameters run faster
  std::vector<WeightedValue> values(pairs);
  for (std::size_t pair = 0; pair < pairs; ++pair) {
    values[pair].value = derived(model.functionAt(pointOf(posterior, pair * block)));
    for (std::size_t i = 0; i < block; ++i) {
      values[pair].mass += posterior.mass[pair * block + i];
    }
  }
  return percentileInterval(std::move(values), confidence);
}

/// Every parameter at the median of its marginal.
ParameterPoint medianOf(const Posterior& posterior) {
  ParameterPoint point;
  for (int i = 0; i < kParameters; ++i) {
    point[i] = credibleInterval(posterior, i, 0).low;
  }
  return point;
}

void setIntervals(Fit& fit, const Model& model, const Posterior& posterior) {
  const double confidence = fit.confidence;
  const Interval place = credibleInterval(posterior, kThreshold, confidence);
  fit.threshold.interval = {fromAxis(fit.function, place.low), fromAxis(fit.function, place.high)};
  const Interval scale = credibleInterval(posterior, kScale, confidence);
  fit.width.interval = {model.widthOf(scale.low), model.widthOf(scale.high)};
  if (fit.w) {
    fit.w->interval = {weberParameter(fit.function.sigmoid, fit.width.interval.low),
                       weberParameter(fit.function.sigmoid, fit.width.interval.high)};
  }
  fit.jnd.interval = derivedInterval(model, posterior, confidence, jndOf);
  fit.weber_fraction.interval = derivedInterval(model, posterior, confidence, weberFractionOf);
  fit.lapse.interval = credibleInterval(posterior, kLapse, confidence);
  fit.guess.interval =
      fit.design == Design::kEqualAsymptote ? fit.lapse.interval : credibleInterval(posterior, kGuess, confidence);
  fit.overdispersion.interval = credibleInterval(posterior, kOverdispersion, confidence);
}

/// The percentiles of simulated fits.
class Bootstrap {
 public:
  Bootstrap(const Model& model, const SimulatedFits& fits) : model_(model), fits_(fits) {}

  /// Of a value that each fitted point has; NaN without simulations.
  [[nodiscard]] Interval interval(const std::function<double(const ParameterPoint&)>& value) const {
    if (fits_.points.empty()) {
      return {};
    }
    std::vector<WeightedValue> values;
    for (const ParameterPoint& point : fits_.points) {
      values.push_back({value(point), 1});
    }
    return percentileInterval(std::move(values), model_.options().confidence);
  }

  [[nodiscard]] Interval interval(double (*derived)(const PsychometricFunction&)) const {
    return interval([&](const ParameterPoint& point) { return derived(model_.functionAt(point)); });
  }

  [[nodiscard]] Interval interval(Parameter parameter) const {
    return interval([parameter](const ParameterPoint& point) { return point[parameter]; });
  }

 private:
  const Model& model_;
  const SimulatedFits& fits_;
};

}  // namespace

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
  const ParameterPoint most_probable = optimumNear(model, posterior.best, Objective::kPosterior);
  const ParameterPoint most_likely = optimumNear(model, most_probable, Objective::kLikelihood);
  const bool median =
      options.estimate.value_or(isWeber(options.sigmoid) ? PointEstimate::kMedian : PointEstimate::kMap) ==
      PointEstimate::kMedian;
  const SimulatedFits simulated = simulatedFits(model, most_likely);
  Fit fit = fitAt(model, median ? medianOf(posterior) : most_probable, most_likely, simulated);
  fit.method = median ? FitMethod::kMedian : FitMethod::kMap;
  fit.log_evidence = posterior.log_evidence;
  setIntervals(fit, model, posterior);
  for (const ParameterPoint& point : drawsOf(posterior, kDraws)) {
    fit.draws.push_back(model.functionAt(point));
  }
  return fit;
}

Fit fitMaximumLikelihood(std::span<const Level> levels, const FitOptions& options) {
  const Model model(levels, options);
  const ParameterPoint start = posteriorOf(model).best;
  const ParameterPoint best = optimumNear(model, start, Objective::kLikelihood);
  const SimulatedFits simulated = simulatedFits(model, best);
  Fit fit = fitAt(model, best, best, simulated);
  fit.method = FitMethod::kMaximumLikelihood;
  const Bootstrap bootstrap(model, simulated);
  fit.threshold.interval = bootstrap.interval(+[](const PsychometricFunction& it) { return it.threshold; });
  fit.width.interval = bootstrap.interval(+[](const PsychometricFunction& it) { return it.width; });
  fit.jnd.interval = bootstrap.interval(jndOf);
  fit.weber_fraction.interval = bootstrap.interval(weberFractionOf);
  if (fit.w) {
    fit.w->interval =
        bootstrap.interval(+[](const PsychometricFunction& it) { return weberParameter(it.sigmoid, it.width); });
  }
  fit.lapse.interval = bootstrap.interval(kLapse);
  fit.guess.interval = bootstrap.interval(+[](const PsychometricFunction& it) { return it.guess; });
  fit.overdispersion.interval = bootstrap.interval(kOverdispersion);
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
