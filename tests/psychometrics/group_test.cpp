#include "haptolith/psychometrics/group.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/psychometrics/goodness_of_fit.h"

namespace haptolith {
namespace {

const std::vector<double> kStimuli{0.270, 0.45, 0.625, 1.0, 1.314, 2.2, 3.721, 6, 9.807};
constexpr double kReference = 1.625;

FitOptions quick() {
  FitOptions options = weberOptions(kReference);
  options.simulations = 0;
  return options;
}

/// People with these Weber fractions, each stimulus `n` times.
std::vector<std::vector<Level>> people(const std::vector<double>& weber_fractions, double n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<Level> levels;
  for (const double x : kStimuli) {
    levels.push_back({x, 0, n});
  }
  std::vector<std::vector<Level>> result;
  for (const double w : weber_fractions) {
    result.push_back(simulatedAnswers(levels, weberFunction(kReference, w), random));
  }
  return result;
}

TEST(Group, FindsMedianAndSpreadOfPeople) {
  // ln w is -0.9 to 0.9 about ln 1.2 in even steps: a standard deviation of 0.6.
  std::vector<double> fractions;
  for (int i = -4; i <= 4; ++i) {
    fractions.push_back(1.2 * std::exp(0.9 * i / 4));
  }
  const GroupFit group = fitGroup(people(fractions, 40, 1), quick());
  ASSERT_EQ(group.participants.size(), 9u);
  EXPECT_NEAR(group.scale.median.value, 1.2, 0.3);
  EXPECT_LT(group.scale.median.interval.low, 1.2);
  EXPECT_GT(group.scale.median.interval.high, 1.2);
  EXPECT_LT(group.scale.spread.interval.low, 0.6);
  EXPECT_GT(group.scale.spread.interval.high, 0.6);
  EXPECT_GT(group.scale.spread.interval.low, 0.3);
  EXPECT_EQ(group.pooled.n_trials, 9 * 9 * 40);
  EXPECT_FALSE(group.threshold.has_value());
}

TEST(Group, OfPeopleAllAlikeHasLittleSpread) {
  const GroupFit alike = fitGroup(people(std::vector<double>(9, 1.2), 40, 2), quick());
  EXPECT_LT(alike.scale.spread.interval.high, 0.35);
  EXPECT_NEAR(alike.scale.median.value, 1.2, 0.15);
}

TEST(Group, DrawsUncertainPeopleTowardsTheMedian) {
  const std::vector<std::vector<Level>> few = people({0.5, 1, 1, 1, 1, 1, 2.5}, 6, 3);
  const GroupFit group = fitGroup(few, quick());
  for (std::size_t i = 0; i < few.size(); ++i) {
    const double own = std::log(group.participants[i].w->value);
    const double within = std::log(group.scale.participants[i].value);
    const double median = std::log(group.scale.median.value);
    EXPECT_LE(std::abs(within - median), std::abs(own - median) + 0.12) << i;
  }
}

TEST(Group, AlsoTellsThresholdsWhereTheyAreFree) {
  FitOptions options = quick();
  options.threshold.reset();
  const GroupFit group = fitGroup(people({0.8, 0.9, 1}, 30, 4), options);
  ASSERT_TRUE(group.threshold.has_value());
  EXPECT_NEAR(group.threshold->median.value, kReference, 0.3);
  EXPECT_LT(group.threshold->median.interval.low, kReference);
  EXPECT_GT(group.threshold->median.interval.high, kReference);
  EXPECT_EQ(group.threshold->participants.size(), 3u);
}

TEST(Group, OfNobodyIsRefused) {
  EXPECT_THROW((void)fitGroup({}, quick()), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
