#include "haptolith/psychometrics/group/group_difference.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/goodness_of_fit.h"

namespace haptolith {
namespace {

constexpr double kReference = 1.625;

/// People with these Weber fractions, whose PSE is `shift` times the reference.
GroupFit groupOf(const std::vector<double>& weber_fractions, double n, unsigned seed, double shift = 1) {
  std::mt19937_64 random(seed);
  std::vector<std::vector<Level>> people;
  for (const double w : weber_fractions) {
    std::vector<Level> levels;
    for (const double x : {0.270, 0.45, 0.625, 1.0, 1.314, 2.2, 3.721, 6.0, 9.807}) {
      levels.push_back({x, 0, n});
    }
    people.push_back(simulatedAnswers(levels, weberFunction(kReference * shift, w), random));
  }
  FitOptions options = weberOptions(kReference);
  options.threshold.reset();
  options.simulations = 0;
  return fitGroup(people, groupOptions(options));
}

std::vector<UnderBoth> paired(std::size_t count) {
  std::vector<UnderBoth> people;
  for (std::size_t i = 0; i < count; ++i) {
    people.push_back({i, i});
  }
  return people;
}

std::vector<UnderBoth> apart(std::size_t count) {
  std::vector<UnderBoth> people;
  for (std::size_t i = 0; i < count; ++i) {
    people.push_back({.first = i});
    people.push_back({.second = i});
  }
  return people;
}

const std::vector<double> kBefore{0.3, 0.5, 0.7, 0.9, 1.2, 1.6, 2.2, 3};

std::vector<double> times(double factor) {
  std::vector<double> after;
  for (const double w : kBefore) {
    after.push_back(factor * w);
  }
  return after;
}

TEST(GroupDifference, FindsARatioAndItsIntervalPairedWithinPeople) {
  const GroupFit before = groupOf(kBefore, 60, 1);
  const GroupFit after = groupOf(times(1.5), 60, 2);
  const Change change = changeBetween(before.scale, after.scale, paired(8), 0.95);
  EXPECT_NEAR(std::exp(change.mean.value), 1.5, 0.2);
  EXPECT_GT(change.mean.interval.low, 0);
  EXPECT_LT(change.mean.interval.low, std::log(1.5));
  EXPECT_GT(change.mean.interval.high, std::log(1.5));
  EXPECT_LT(change.same, 0.05);
  const Change unpaired = changeBetween(before.scale, after.scale, apart(8), 0.95);
  EXPECT_NEAR(unpaired.mean.value, change.mean.value, 0.15);
  const auto length = [](const Interval& it) { return it.high - it.low; };
  EXPECT_GT(length(unpaired.mean.interval), 2 * length(change.mean.interval));  // people differ by a factor of ten
}

TEST(GroupDifference, OfTheSameSpeaksForNone) {
  const Change change = changeBetween(groupOf(kBefore, 60, 3).scale, groupOf(kBefore, 60, 4).scale, paired(8), 0.95);
  EXPECT_LT(change.mean.interval.low, 0);
  EXPECT_GT(change.mean.interval.high, 0);
  EXPECT_GT(change.same, 2);
}

TEST(GroupDifference, OfThresholdsIsToldFromTheirReferences) {
  const GroupFit before = groupOf(std::vector<double>(8, 0.8), 30, 5);
  const GroupFit after = groupOf(std::vector<double>(8, 0.8), 30, 6, 1.3);
  const Change change = changeBetween(*before.threshold, *after.threshold, paired(8), 0.95);
  EXPECT_NEAR(change.mean.value, std::log(1.3), 0.06);
  const Change less = changeBetween(*before.threshold, *after.threshold, paired(8), 0.95, std::log(1.3));
  EXPECT_NEAR(less.mean.value, change.mean.value - std::log(1.3), 0.01);
}

TEST(GroupDifference, NeedsSomebodyUnderEachCondition) {
  EXPECT_THROW((void)changeBetween(groupOf({1, 1}, 5, 7).scale, {}, paired(2), 0.95), InvalidParameter);
}

// --- between groups
// ---------------------------------------------------------------------------------------------------

/// A normal density in `count` values within five deviations.
Marginal normal(double mean, double deviation, int count) {
  Marginal marginal{.values = evenly({mean - 5 * deviation, mean + 5 * deviation}, count)};
  for (const double value : marginal.values) {
    marginal.log_density.push_back(-std::pow((value - mean) / deviation, 2) / 2);
  }
  return marginal;
}

TEST(BetweenGroups, TheDifferenceOfTwoNormalPosteriorsIsNormal) {
  const Population first{.median_place = normal(-1, 0.3, 15), .prior = {0.4}};
  const Population second{.median_place = normal(-0.5, 0.4, 21), .prior = {0.4}};
  const Change change = changeBetweenGroups(first, second, 0.95);
  EXPECT_NEAR(change.mean.value, 0.5, 2e-3);
  EXPECT_NEAR(change.mean.interval.low, 0.5 - 1.95996 * 0.5, 5e-3);
  EXPECT_NEAR(change.mean.interval.high, 0.5 + 1.95996 * 0.5, 5e-3);
  const auto density = [](double value, double variance) {
    return std::exp(-value * value / (2 * variance)) / std::sqrt(variance);
  };
  EXPECT_NEAR(change.same, density(0.5, 0.25) / density(0.5, 0.25 + 0.16), 5e-3) << "over the prior's average";
  const Change less = changeBetweenGroups(first, second, 0.95, 0.2);
  EXPECT_NEAR(less.mean.value, change.mean.value - 0.2, 1e-9);
}

TEST(BetweenGroups, FindsARatioWithAnIntervalAsOfPeopleWhoAreNotPaired) {
  const GroupFit one = groupOf(kBefore, 60, 1);
  const GroupFit other = groupOf(times(1.5), 60, 2);
  const Change change = changeBetweenGroups(one.scale, other.scale, 0.95);
  EXPECT_NEAR(change.mean.value, std::log(other.scale.median.value / one.scale.median.value), 0.02);
  EXPECT_NEAR(change.mean.value, std::log(1.5), 0.15);
  const Change unpaired = changeBetween(one.scale, other.scale, apart(8), 0.95);
  const auto length = [](const Interval& it) { return it.high - it.low; };
  EXPECT_NEAR(length(change.mean.interval), length(unpaired.mean.interval), 0.25 * length(unpaired.mean.interval));
  const Change threshold = changeBetweenGroups(*one.threshold, *groupOf(kBefore, 60, 3, 1.3).threshold, 0.95);
  EXPECT_NEAR(threshold.mean.value, std::log(1.3), 0.2);
}

TEST(BetweenGroups, NeedsSomebodyInEachGroup) {
  EXPECT_THROW((void)changeBetweenGroups(groupOf({1, 1}, 5, 7).scale, {}, 0.95), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
