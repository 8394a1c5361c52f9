#include "haptolith/psychometrics/group_difference.h"

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

}  // namespace
}  // namespace haptolith
