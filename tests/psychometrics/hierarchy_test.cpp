#include "haptolith/psychometrics/group/hierarchy.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace haptolith {
namespace {

/// A participant whose responses make `first` normal about this value, without information on `second`.
PersonTable somebody(double place, double deviation) {
  return closedTable({-10, 10}, {0, 0}, {0}, Effort::kThorough,
                     [=](const std::vector<double>& first, const std::vector<double>& second) {
                       Eigen::ArrayXXd log(std::ssize(first), std::ssize(second));
                       for (Eigen::Index row = 0; row < log.rows(); ++row) {
                         const double away = (first[row] - place) / deviation;
                         log.row(row) = -away * away / 2;
                       }
                       return [log](double) { return log; };
                     });
}

HierarchyPriors withSpread(const Support& spread) {
  HierarchyPriors priors;
  priors.supports = {Support{-10, 10}, spread, {0, 0}, {0, 0}, {0, 0}};
  return priors;
}

// With a known spread s between people whose places y_i are known to within d, the mean's posterior is normal, about
// the mean of the y_i, with the variance (s^2 + d^2)/n.
TEST(Hierarchy, HasTheNormalPosteriorOfAKnownSpread) {
  const std::vector<double> places{-1.2, -0.3, 0.1, 0.4, 2.0};
  for (const double deviation : {0.02, 0.3, 1.0}) {
    for (const double spread : {0.0, 0.1, 0.7}) {
      std::vector<PersonTable> people;
      for (const double place : places) {
        people.push_back(somebody(place * (spread + deviation), deviation));
      }
      const HierarchyPosterior posterior = hierarchyOf(people, withSpread({spread, spread}), Effort::kQuick);
      const Estimate mean = estimateOf(posterior.marginals[kFirstMean], 0.95);
      const double expected = 0.2 * (spread + deviation);
      const double sigma = std::sqrt((spread * spread + deviation * deviation) / 5);
      EXPECT_NEAR(mean.value, expected, 0.02 * sigma) << deviation << " " << spread;
      EXPECT_NEAR(mean.interval.low, expected - 1.96 * sigma, 0.08 * sigma) << deviation << " " << spread;
      EXPECT_NEAR(mean.interval.high, expected + 1.96 * sigma, 0.08 * sigma) << deviation << " " << spread;
    }
  }
}

// As above for a participant: their own estimate and the group's, weighted by precision, for a large group.
TEST(Hierarchy, DrawsAPersonTowardsTheGroup) {
  std::vector<PersonTable> people(200, somebody(0, 0.5));
  people.push_back(somebody(2, 0.5));
  const HierarchyPosterior posterior = hierarchyOf(people, withSpread({0.5, 0.5}), Effort::kThorough);
  double mean = 0;
  for (Eigen::Index i = 0; i < posterior.people.back().rows(); ++i) {
    mean += people.back().first[i] * posterior.people.back()(i, 0);
  }
  EXPECT_NEAR(mean, 1, 0.05);
}

TEST(Hierarchy, FindsTheSpreadOfPeople) {
  std::vector<PersonTable> people;
  for (int i = -20; i <= 20; ++i) {
    people.push_back(somebody(0.05 * i, 0.05));
  }
  const HierarchyPosterior posterior = hierarchyOf(people, withSpread({0, 3}), Effort::kQuick);
  EXPECT_NEAR(estimateOf(posterior.marginals[kFirstSpread], 0.95).value, 0.59, 0.03);
}

TEST(Hierarchy, SaysHowLikelyNoSpreadIs) {
  const SpreadPrior prior{0.5};
  HierarchyPriors priors = withSpread(prior.support());
  priors.log_densities[kFirstSpread] = [&](double spread) { return prior.logDensity(spread); };
  const std::vector<PersonTable> alike(30, somebody(0, 0.3));
  const HierarchyPosterior same = hierarchyOf(alike, priors, Effort::kQuick);
  EXPECT_GT(prior.bayesFactorOfNone(same.marginals[kFirstSpread]), 3);
  std::vector<PersonTable> different;
  for (int i = 0; i < 30; ++i) {
    different.push_back(somebody(0.1 * i, 0.3));
  }
  const HierarchyPosterior unlike = hierarchyOf(different, priors, Effort::kQuick);
  EXPECT_LT(prior.bayesFactorOfNone(unlike.marginals[kFirstSpread]), 1e-3);
}

TEST(Marginal, OfANormalDistributionHasItsPercentilesAndDensity) {
  Marginal normal;
  for (const double value : evenly({-4, 5}, 15)) {
    normal.values.push_back(value);
    normal.log_density.push_back(-value * value / 2);
  }
  const Estimate estimate = estimateOf(normal, 0.95);
  EXPECT_NEAR(estimate.value, 0, 2e-3);
  EXPECT_NEAR(estimate.interval.low, -1.96, 4e-3);
  EXPECT_NEAR(estimate.interval.high, 1.96, 4e-3);
  EXPECT_NEAR(densityAt(normal, 0.5), 0.3521, 5e-3);
  EXPECT_EQ(densityAt(normal, 6), 0);
}

constexpr double kImpossible = -std::numeric_limits<double>::infinity();

// A density that falls to 0 at both ends, as a threshold's prior does: (1 + cos x) / 2 pi from -pi to pi.
TEST(Marginal, OfADensityThatFallsTo0HasItsPercentiles) {
  Marginal marginal;
  for (const double value : evenly({-std::numbers::pi, std::numbers::pi}, 21)) {
    const double density = (1 + std::cos(value)) / 2;
    marginal.values.push_back(value);
    marginal.log_density.push_back(density > 1e-12 ? std::log(density) : kImpossible);
  }
  const Estimate estimate = estimateOf(marginal, 0.95);
  EXPECT_NEAR(estimate.value, 0, 1e-3);
  EXPECT_NEAR(estimate.interval.low, -2.1453, 0.01);  // solves x + sin x = -0.95 pi
  EXPECT_NEAR(estimate.interval.high, 2.1453, 0.01);
}

// The cubic between values swings out by 4/27 of a cliff next to its cell, in the logarithm: e^51 of 344.
TEST(Marginal, HasNoPeakNextToACliff) {
  for (const double cliff : {-50.0, -691.0, -1e300, kImpossible}) {
    const Marginal marginal{evenly({0, 8}, 9), {-3, -1, 0, -1, -3, -5, -6, -7, cliff}};
    const Estimate estimate = estimateOf(marginal, 0.95);
    EXPECT_NEAR(estimate.value, 2, 0.1) << cliff;
    EXPECT_LT(estimate.interval.high, 4.5) << cliff;
    EXPECT_LT(densityAt(marginal, 7.3), 1e-3) << cliff;
  }
}

}  // namespace
}  // namespace haptolith
