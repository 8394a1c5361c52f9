#include "haptolith/psychometrics/group/group.h"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/goodness_of_fit.h"
#include "haptolith/psychometrics/levels.h"
#include "haptolith/psychometrics/likelihood.h"
#include "haptolith/psychometrics/model.h"
#include "haptolith/psychometrics/posterior.h"
#include "haptolith/psychometrics/psychometric_function.h"

namespace haptolith {

namespace {

// SDs of the half-normal priors of the spread between participants, which keep it bounded with few responses. For
// ln(Weber fraction) or ln(width) a factor of e^0.6 = 1.8; for thresholds a quarter of the stimuli's range.
constexpr double kUsualLogSpread = 0.6;
constexpr double kUsualThresholdSpread = 0.125;  // in units of the support, which is twice that range
// Beta(1, 100) is the prior of the common lapse rate, chosen by simulation (docs/reports/psychometric-coverage.md).
// With a wider one, few responses of sensitive participants with lapses resemble those without lapses, and the Weber
// fraction has no lower bound.
constexpr double kLapseBeta = 100;
constexpr std::array kLapses{0.001, 0.02, 0.08};  // lapse rates that a table covers, if the rate is free
constexpr int kGuesses = 9;
constexpr int kOverdispersions = 7;

/// Guess rate and eta of a nuisance sum, with their weight.
struct Nuisance {
  double guess, eta, weight;
};

/// Returns values of an individual parameter, dense at the lower end, with their prior masses.
std::vector<WeightedValue> nuisanceValues(const Model& model, int parameter, int count) {
  const Support& support = model.support(parameter);
  if (support.isFixed()) {
    return {{support.low, 1}};
  }
  std::vector<WeightedValue> values;
  values.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {  // centres of cells of equal size in the square root
    const double root = (i + 0.5) / count;
    const double value = support.low + (support.high - support.low) * root * root;
    values.push_back({value, std::exp(model.logPrior(parameter, value)) * root});
  }
  return values;
}

std::vector<Nuisance> nuisancesOf(const Model& model) {
  std::vector<Nuisance> result;
  double total = 0;
  for (const WeightedValue& guess : nuisanceValues(model, kGuess, kGuesses)) {
    for (const WeightedValue& eta : nuisanceValues(model, kOverdispersion, kOverdispersions)) {
      result.push_back({guess.value, eta.value, guess.mass * eta.mass});
      total += result.back().weight;
    }
  }
  for (Nuisance& nuisance : result) {
    nuisance.weight /= total;
  }
  return result;
}

/// Log-likelihood of one participant over thresholds (rows) and logarithms of the scale (columns).
class Likelihood {
 public:
  Likelihood(const Model& model, std::vector<Level> levels, const std::vector<double>& places,
             const std::vector<double>& log_scales)
      : model_(model), levels_(std::move(levels)), nuisances_(nuisancesOf(model)) {
    const PsychometricFunction axis = model.functionAt({places.front(), std::exp(log_scales.front()), 0, 0, 0});
    shapes_.reserve(levels_.size());
    for (const Level& level : levels_) {
      Eigen::ArrayXXd shape(std::ssize(places), std::ssize(log_scales));
      for (Eigen::Index column = 0; column < shape.cols(); ++column) {
        const double width = model.widthOf(std::exp(log_scales[column]));
        for (Eigen::Index row = 0; row < shape.rows(); ++row) {
          shape(row, column) = standardSigmoid(axis.sigmoid, (toAxis(axis, level.x) - places[row]) / width);
        }
      }
      shapes_.push_back(std::move(shape));
    }
  }

  [[nodiscard]] Eigen::ArrayXXd at(double lapse) const {
    if (nuisances_.size() == 1) {
      return with(lapse, nuisances_.front());
    }
    Eigen::ArrayXXd sum = Eigen::ArrayXXd::Constant(shapes_.front().rows(), shapes_.front().cols(),
                                                    -std::numeric_limits<double>::infinity());
    for (const Nuisance& nuisance : nuisances_) {
      const Eigen::ArrayXXd log = with(lapse, nuisance) + std::log(nuisance.weight);
      const Eigen::ArrayXXd larger = sum.max(log).max(-1e300);
      sum = larger + ((sum - larger).exp() + (log - larger).exp()).log();
    }
    return sum;
  }

 private:
  [[nodiscard]] Eigen::ArrayXXd with(double lapse, const Nuisance& nuisance) const {
    const double guess = model_.guessAt({0, 0, lapse, nuisance.guess, nuisance.eta});
    Eigen::ArrayXXd sum = Eigen::ArrayXXd::Zero(shapes_.front().rows(), shapes_.front().cols());
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      const double k = levels_[i].k;
      const double n = levels_[i].n;
      const Eigen::ArrayXXd psi = guess + (1 - guess - lapse) * shapes_[i];
      if (nuisance.eta > 0) {
        sum += psi.unaryExpr([&](double it) { return logLikelihood(k, n, it, nuisance.eta); });
        continue;
      }
      if (k > 0) {
        sum += k * psi.log();
      }
      if (n > k) {
        sum += (n - k) * (1 - psi).log();
      }
    }
    return sum;
  }

  Model model_;
  std::vector<Level> levels_;
  std::vector<Nuisance> nuisances_;
  std::vector<Eigen::ArrayXXd> shapes_;  // the sigmoid at each level
};

/// Returns the table of a participant's likelihood, where it is not negligible.
PersonTable tableOf(const Model& model, const std::vector<Level>& levels, const Support& place,
                    const Support& log_scale, Effort effort) {
  const Support& lapse = model.support(kLapse);
  const std::vector<double> lapses =
      lapse.isFixed() ? std::vector{lapse.low} : std::vector(kLapses.begin(), kLapses.end());
  return closedTable(place, log_scale, lapses, effort,
                     [&](const std::vector<double>& places, const std::vector<double>& log_scales) {
                       const auto likelihood = std::make_shared<Likelihood>(model, levels, places, log_scales);
                       return [likelihood](double shared) { return likelihood->at(shared); };
                     });
}

/// Ranges of thresholds on their axis and of the logarithms of widths or Weber fractions, and their spreads.
struct Axes {
  Support place, log_scale;
  SpreadPrior place_spread, log_scale_spread;
};

Axes axesOf(const Model& model) {
  const Support& place = model.support(kThreshold);
  const Support& scale = model.support(kScale);
  return {.place = place,
          .log_scale = {std::log(scale.low), std::log(scale.high)},
          .place_spread = {kUsualThresholdSpread * (place.high - place.low)},
          .log_scale_spread = {kUsualLogSpread}};
}

HierarchyPriors priorsOf(const Model& model, const Axes& axes) {
  HierarchyPriors priors;
  priors.supports = {axes.place, axes.place_spread.support(), axes.log_scale, axes.log_scale_spread.support(),
                     model.support(kLapse)};
  priors.log_densities = {[&model](double place) { return model.logPrior(kThreshold, place); },
                          [prior = axes.place_spread](double spread) { return prior.logDensity(spread); }, nullptr,
                          [prior = axes.log_scale_spread](double spread) { return prior.logDensity(spread); },
                          [](double lapse) { return (kLapseBeta - 1) * std::log1p(-lapse); }};
  if (axes.place.isFixed()) {
    priors.log_densities[kFirstSpread] = nullptr;
  }
  return priors;
}

/// Returns a marginal of one of a participant's two numbers.
Marginal marginalOf(const std::vector<double>& values, const Eigen::ArrayXd& likelihood) {
  const Eigen::ArrayXd log = (likelihood / likelihood.maxCoeff()).max(1e-300).log();
  return {values, {log.begin(), log.end()}};
}

template <class ToUnit>
Estimate inUnit(const Estimate& estimate, const ToUnit& to_unit) {
  return {to_unit(estimate.value), {to_unit(estimate.interval.low), to_unit(estimate.interval.high)}};
}

Estimate estimateOf(const std::vector<WeightedValue>& values, double confidence) {
  return {percentileInterval(values, 0).low, percentileInterval(values, confidence)};
}

/// Writes a fit from a joint distribution of threshold and scale.
class FitWriter {
 public:
  FitWriter(const Model& model, const Estimate& lapse, double guess) : model_(model), lapse_(lapse), guess_(guess) {}

  /// @param place, scale  threshold on its axis, and width or Weber fraction. @param mass  rows: places.
  [[nodiscard]] Fit write(const std::vector<Level>& levels, const Estimate& place, const Estimate& scale,
                          const std::vector<double>& places, const std::vector<double>& log_scales,
                          const Eigen::ArrayXXd& mass) const {
    Fit fit{.method = FitMethod::kMedian,
            .design = model_.options().design,
            .confidence = model_.options().confidence,
            .levels = pooled(levels)};
    fit.function = functionAt({place.value, scale.value, lapse_.value, guess_, 0});
    fit.doubt = doubtOf(fit.levels, model_.options());
    const auto widths = [this](double value) { return model_.widthOf(value); };
    fit.threshold = inUnit(place, [&](double value) { return fromAxis(fit.function, value); });
    fit.width = inUnit(scale, widths);
    if (isWeber(fit.function.sigmoid)) {
      fit.w = inUnit(fit.width, [&](double width) { return weberParameter(fit.function.sigmoid, width); });
    }
    fit.lapse = lapse_;
    fit.guess = fit.design == Design::kEqualAsymptote ? lapse_ : Estimate{guess_, {guess_, guess_}};
    fit.jnd = derived(places, log_scales, mass, jndOf);
    fit.weber_fraction = derived(places, log_scales, mass, weberFractionOf);
    if (isWeber(fit.function.sigmoid)) {
      fit.weber_fraction = scale;  // directly, not from the grid
    }
    for (const Level& level : fit.levels) {
      fit.n_trials += level.n;
    }
    fit.free_parameters = (model_.support(kThreshold).isFixed() ? 1 : 2) + (model_.support(kLapse).isFixed() ? 0 : 1);
    return fit;
  }

  [[nodiscard]] PsychometricFunction functionAt(ParameterPoint point) const {
    point[kGuess] = guess_;
    return model_.functionAt(point);
  }

 private:
  [[nodiscard]] Estimate derived(const std::vector<double>& places, const std::vector<double>& log_scales,
                                 const Eigen::ArrayXXd& mass, double (*of)(const PsychometricFunction&)) const {
    std::vector<WeightedValue> values;
    values.reserve(places.size() * log_scales.size());
    for (std::size_t row = 0; row < places.size(); ++row) {
      for (std::size_t column = 0; column < log_scales.size(); ++column) {
        const double share = mass(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
        if (share > 0) {
          values.push_back({of(functionAt({places[row], std::exp(log_scales[column]), 0, 0, 0})), share});
        }
      }
    }
    return estimateOf(values, model_.options().confidence);
  }

  const Model& model_;
  Estimate lapse_;
  double guess_;
};

std::vector<WeightedValue> weighted(const std::vector<double>& values, const Eigen::ArrayXd& mass) {
  std::vector<WeightedValue> result;
  result.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    result.push_back({values[i], mass[static_cast<Eigen::Index>(i)]});
  }
  return result;
}

double exponential(double place) {
  return std::exp(place);
}

/// Returns the guess rate of the median function: with a free guess rate that of all participants' responses.
double guessOf(std::span<const std::vector<Level>> participants, const Model& model) {
  const Support& guess = model.support(kGuess);
  if (guess.isFixed()) {
    return guess.low;
  }
  FitOptions options = model.options();
  options.simulations = 0;
  return fitPsychometric(pooled(participants), options).guess.value;
}

std::optional<Fit> fitAlone(const std::vector<Level>& levels, FitOptions options, double lapse) {
  if (pooled(levels).size() < 2) {
    return std::nullopt;
  }
  options.simulations = 0;
  options.lapse = lapse;
  return fitPsychometric(levels, options);
}

}  // namespace

FitOptions groupOptions(FitOptions of_one_person) {
  of_one_person.lapse.reset();
  of_one_person.overdispersion = 0;
  return of_one_person;
}

GroupFit fitGroup(std::span<const std::vector<Level>> participants, const FitOptions& options, Effort effort) {
  if (participants.empty()) {
    throw InvalidParameter("participants", "none", "one or more");
  }
  const std::vector<Level> all = pooled(participants);
  const Model model(all, options);
  const Axes axes = axesOf(model);
  std::vector<PersonTable> tables;
  tables.reserve(participants.size());
  for (const std::vector<Level>& levels : participants) {
    tables.push_back(tableOf(model, pooled(levels), axes.place, axes.log_scale, effort));
  }
  const HierarchyPriors priors = priorsOf(model, axes);
  const HierarchyPosterior posterior = hierarchyOf(tables, priors, effort);

  const auto& marginals = posterior.marginals;
  const double confidence = options.confidence;
  const FitWriter writer(model, estimateOf(marginals[kShared], confidence), guessOf(participants, model));
  const auto to_unit = [&](double place) { return fromAxis(writer.functionAt({place, 1, 0, 0, 0}), place); };
  GroupFit group;
  const Estimate place = estimateOf(marginals[kFirstMean], confidence);
  group.scale.median = inUnit(estimateOf(marginals[kSecondMean], confidence), exponential);
  group.scale.median_place = marginals[kSecondMean];
  group.scale.spread = estimateOf(marginals[kSecondSpread], confidence);
  group.scale.prior = axes.log_scale_spread;
  group.scale.alike = group.scale.prior.bayesFactorOfNone(marginals[kSecondSpread]);
  group.median_person = writer.write(all, place, group.scale.median, marginals[kFirstMean].values,
                                     marginals[kSecondMean].values, posterior.means);
  for (const HyperPoint& point : posterior.draws) {
    group.median_person.draws.push_back(
        writer.functionAt({point[kFirstMean], std::exp(point[kSecondMean]), point[kShared], 0, 0}));
  }
  if (!axes.place.isFixed()) {
    group.threshold = Population{.median = group.median_person.threshold,
                                 .median_place = marginals[kFirstMean],
                                 .spread = estimateOf(marginals[kFirstSpread], confidence),
                                 .prior = axes.place_spread,
                                 .alike = axes.place_spread.bayesFactorOfNone(marginals[kFirstSpread])};
  }
  for (std::size_t i = 0; i < posterior.people.size(); ++i) {
    const Eigen::ArrayXXd& mass = posterior.people[i];
    const PersonTable& table = tables[i];
    const Estimate own_place = estimateOf(weighted(table.first, mass.rowwise().sum()), confidence);
    const Estimate own_scale =
        inUnit(estimateOf(weighted(table.second, mass.colwise().sum().transpose()), confidence), exponential);
    group.participants.push_back(writer.write(participants[i], own_place, own_scale, table.first, table.second, mass));
    group.alone.push_back(fitAlone(participants[i], options, group.median_person.lapse.value));
    group.scale.participants.push_back(own_scale);
    group.scale.likelihoods.push_back(marginalOf(table.second, posterior.second_alone[i]));
    if (group.threshold) {
      group.threshold->participants.push_back(inUnit(own_place, to_unit));
      group.threshold->likelihoods.push_back(marginalOf(table.first, posterior.first_alone[i]));
    }
  }
  return group;
}

}  // namespace haptolith
