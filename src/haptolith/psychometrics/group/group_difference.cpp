#include "haptolith/psychometrics/group/group_difference.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/group/hierarchy.h"

namespace haptolith {

namespace {

constexpr int kPriorPlaces = 401;  // points of the sum over the prior of a change

Support within(const Marginal& likelihood) {
  return {likelihood.values.front(), likelihood.values.back()};
}

/// Returns the range of places of all participants under one condition.
Support reachOf(const Population& population) {
  if (population.likelihoods.empty()) {
    throw InvalidParameter("participants", "none under one of the conditions", "one or more");
  }
  Support reach = within(population.likelihoods.front());
  for (const Marginal& likelihood : population.likelihoods) {
    reach = {std::min(reach.low, within(likelihood).low), std::max(reach.high, within(likelihood).high)};
  }
  return reach;
}

/// Returns the log-likelihood at a place: linear between its values, constant beyond them; 0 without a likelihood.
double logAt(const Marginal* likelihood, double place) {
  if (likelihood == nullptr) {
    return 0;
  }
  const std::vector<double>& values = likelihood->values;
  const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
  const double at = std::clamp((place - values.front()) / step, 0.0, static_cast<double>(values.size() - 1));
  const auto below = std::min(static_cast<std::size_t>(at), values.size() - 2);
  return std::lerp(likelihood->log_density[below], likelihood->log_density[below + 1], at - static_cast<double>(below));
}

/// Returns the table of a participant's likelihood over the mean of their two places and the change between these.
PersonTable tableOf(const Marginal* first, const Marginal* second, double offset, const Support& mean,
                    const Support& change) {
  return closedTable(
      mean, change, {0}, Effort::kThorough, [=](const std::vector<double>& means, const std::vector<double>& changes) {
        Eigen::ArrayXXd log(std::ssize(means), std::ssize(changes));
        for (Eigen::Index row = 0; row < log.rows(); ++row) {
          for (Eigen::Index column = 0; column < log.cols(); ++column) {
            const double half = changes[column] / 2;
            log(row, column) = logAt(first, means[row] - half) + logAt(second, means[row] + half + offset);
          }
        }
        return [log](double) { return log; };
      });
}

double normalDensity(double value, double deviation) noexcept {
  const double deviations = value / deviation;
  return std::exp(-deviations * deviations / 2) / (deviation * std::sqrt(2 * std::numbers::pi));
}

/// Returns the Bayes factor of no change. With a flat prior the posterior equals the likelihood, which is averaged over
/// the prior.
double bayesFactorOfNone(const Marginal& change, double usual) {
  double averaged = 0;
  const double step = (change.values.back() - change.values.front()) / (kPriorPlaces - 1);
  for (const double value : evenly({change.values.front(), change.values.back()}, kPriorPlaces)) {
    averaged += densityAt(change, value) * normalDensity(value, usual) * step;
  }
  return averaged > 0 ? densityAt(change, 0) / averaged : 0;
}

}  // namespace

Change changeBetween(const Population& first, const Population& second, const std::vector<UnderBoth>& people,
                     double confidence, double offset) {
  const Support a = reachOf(first);
  Support b = reachOf(second);
  b = {b.low - offset, b.high - offset};
  const Support mean{std::min(a.low, b.low), std::max(a.high, b.high)};
  const Support change{b.low - a.high, b.high - a.low};
  std::vector<PersonTable> tables;
  tables.reserve(people.size());
  for (const UnderBoth& person : people) {
    tables.push_back(tableOf(person.first ? &first.likelihoods[*person.first] : nullptr,
                             person.second ? &second.likelihoods[*person.second] : nullptr, offset, mean, change));
  }
  HierarchyPriors priors;
  const SpreadPrior prior{std::max(first.prior.usual, second.prior.usual)};
  priors.supports = {mean, prior.support(), change, prior.support(), Support{0, 0}};
  priors.log_densities[kFirstSpread] = [prior](double value) { return prior.logDensity(value); };
  priors.log_densities[kSecondSpread] = priors.log_densities[kFirstSpread];
  const HierarchyPosterior posterior = hierarchyOf(tables, priors, Effort::kQuick);
  const Marginal& of_change = posterior.marginals[kSecondMean];
  return {estimateOf(of_change, confidence), bayesFactorOfNone(of_change, prior.usual), prior};
}

Change changeBetweenGroups(const Population& first, const Population& second, double confidence, double offset) {
  for (const Population* population : {&first, &second}) {
    if (population->median_place.values.size() < 2) {
      throw InvalidParameter("participants", "none in one of the groups", "one or more");
    }
  }
  Marginal change = differenceOf(first.median_place, second.median_place);
  for (double& value : change.values) {
    value -= offset;
  }
  const SpreadPrior prior{std::max(first.prior.usual, second.prior.usual)};
  return {estimateOf(change, confidence), bayesFactorOfNone(change, prior.usual), prior};
}

}  // namespace haptolith
