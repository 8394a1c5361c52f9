#include "haptolith/psychometrics/group/group.h"

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
  EXPECT_EQ(group.median_person.n_trials, 9 * 9 * 40);
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
    const double own = std::log(group.alone[i]->w->value);
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

FitOptions everythingFree() {
  FitOptions options = quick();
  options.threshold.reset();
  return groupOptions(options);
}

TEST(Group, ATimeOrderErrorMovesThePseAndNotTheWeberFraction) {
  std::vector<std::vector<Level>> felt = people(std::vector<double>(8, 1.2), 30, 5);
  for (std::vector<Level>& person : felt) {
    for (Level& level : person) {
      level.x /= 1.2;  // as if each had been felt 20 % more than it is
    }
  }
  const GroupFit group = fitGroup(felt, everythingFree());
  EXPECT_NEAR(group.threshold->median.value, kReference / 1.2, 0.08);
  EXPECT_LT(group.threshold->median.interval.high, kReference);
  EXPECT_NEAR(group.scale.median.value, 1.2, 0.12);
}

TEST(Group, BlindAnswersAreTakenForLapses) {
  std::mt19937_64 random(6);
  PsychometricFunction blind = weberFunction(kReference, 0.5);
  blind.guess = blind.lapse = 0.05;
  std::vector<Level> levels;
  for (const double x : kStimuli) {
    levels.push_back({x, 0, 40});
  }
  std::vector<std::vector<Level>> lapsing;
  for (int i = 0; i < 8; ++i) {
    lapsing.push_back(simulatedAnswers(levels, blind, random));
  }
  const GroupFit group = fitGroup(lapsing, everythingFree());
  EXPECT_NEAR(group.median_person.lapse.value, 0.05, 0.015);
  EXPECT_LT(group.median_person.lapse.interval.low, 0.05);
  EXPECT_GT(group.median_person.lapse.interval.high, 0.05);
  EXPECT_NEAR(group.scale.median.value, 0.5, 0.12);
}

// An interval of people all alike, of many answers, is as narrow as that of the pooled answers, and no single point.
TEST(Group, OfManyAnswersHasAnIntervalAsNarrowAsTheyAllow) {
  const std::vector<std::vector<Level>> alike = people(std::vector<double>(6, 1.2), 1000, 7);
  const Interval group = fitGroup(alike, everythingFree()).scale.median.interval;
  FitOptions options = quick();
  options.threshold.reset();
  const Interval all = fitPsychometric(pooled(alike), options).w->interval;
  EXPECT_LT(group.low, 1.2);
  EXPECT_GT(group.high, 1.2);
  EXPECT_GT(group.high - group.low, 0.8 * (all.high - all.low));
  EXPECT_LT(group.high - group.low, 4 * (all.high - all.low));
}

TEST(Group, SaysWhetherPeopleDiffer) {
  EXPECT_GT(fitGroup(people(std::vector<double>(8, 1.2), 300, 8), everythingFree()).scale.alike, 1);
  EXPECT_LT(fitGroup(people({0.4, 0.5, 0.6, 0.8, 1.6, 2, 2.5, 3}, 30, 9), everythingFree()).scale.alike, 0.1);
}

TEST(Group, OfSomebodyWithOneStimulusHasNoFitOfThemAlone) {
  std::vector<std::vector<Level>> group = people({1, 1}, 10, 10);
  group.push_back({{0.27, 0, 3}});
  const GroupFit fit = fitGroup(group, everythingFree());
  EXPECT_TRUE(fit.alone[0].has_value());
  EXPECT_FALSE(fit.alone[2].has_value());
  EXPECT_GT(fit.participants[2].w->interval.high / fit.participants[2].w->interval.low,
            fit.participants[0].w->interval.high / fit.participants[0].w->interval.low);
}

TEST(Group, OfOtherSigmoidsAndDesignsHasWidths) {
  const std::vector<std::vector<Level>> group = people({0.8, 1, 1.2}, 20, 11);
  for (const Design design : {Design::kEqualAsymptote, Design::kYesNo}) {
    FitOptions options{.sigmoid = Sigmoid::kNorm, .design = design, .log_axis = true};
    options.overdispersion = 0;
    options.simulations = 0;
    const GroupFit fit = fitGroup(group, options);
    EXPECT_NEAR(fit.scale.median.value, weberWidth(Sigmoid::kWeber, 1), 0.7);
    EXPECT_FALSE(fit.median_person.w.has_value());
    EXPECT_NEAR(fit.median_person.jnd.value, kReference * 1.0, 0.5);
  }
}

TEST(Group, OfNobodyIsRefused) {
  EXPECT_THROW((void)fitGroup({}, quick()), InvalidParameter);
}

// Pilots have two or three people.
TEST(Group, OfTwoPeopleHasTheirPse) {
  const std::vector<double> xs{0.5, 0.65, 0.78, 0.9, 1.05, 1.3};
  const std::vector<std::vector<double>> answers{{0, 1, 3, 5, 11, 17}, {0, 0, 1, 4, 14, 17}};
  std::vector<std::vector<Level>> two(answers.size());
  for (std::size_t person = 0; person < answers.size(); ++person) {
    for (std::size_t i = 0; i < xs.size(); ++i) {
      two[person].push_back({xs[i], answers[person][i], 20});
    }
  }
  FitOptions options = weberOptions(0.835);
  options.threshold.reset();
  const GroupFit group = fitGroup(two, options);
  EXPECT_NEAR(group.threshold->participants[0].value, 1.04, 0.02);
  EXPECT_NEAR(group.threshold->participants[1].value, 1.04, 0.02);
  EXPECT_NEAR(group.threshold->median.value, 1.04, 0.02);
  EXPECT_NEAR(group.threshold->median.interval.low, 0.8, 0.1);
  EXPECT_NEAR(group.threshold->median.interval.high, 1.3, 0.1);
}

/// Simulated groups of `count` people with the paper's friction levels, each level `n` times; their PSEs differ by 0.1
/// in the logarithm. How often the interval of the group's PSE holds the median of all people.
double coverageOfPse(int count, double n, int tables) {
  constexpr double kPse = 0.9, kWeber = 0.29, kSpread = 0.1;
  std::mt19937_64 random(static_cast<unsigned>(100 * count) + static_cast<unsigned>(n));
  std::normal_distribution<double> normal;
  std::vector<Level> levels;
  for (const double x : {0.5, 0.65, 0.78, 0.9, 1.05, 1.3}) {
    levels.push_back({x, 0, n});
  }
  FitOptions options = weberOptions(0.835);
  options.threshold.reset();
  int held = 0;
  for (int table = 0; table < tables; ++table) {
    std::vector<std::vector<Level>> group;
    for (int person = 0; person < count; ++person) {
      const PsychometricFunction truth = weberFunction(kPse * std::exp(kSpread * normal(random)), kWeber);
      group.push_back(simulatedAnswers(levels, truth, random));
    }
    const Estimate pse = fitGroup(group, groupOptions(options), Effort::kQuick).threshold->median;
    EXPECT_GT(pse.value, 0.55) << count << " people, " << n << " answers, table " << table;
    EXPECT_LT(pse.value, 1.5) << count << " people, " << n << " answers, table " << table;
    EXPECT_GT(pse.interval.high, pse.value) << count << " people, " << n << " answers, table " << table;
    EXPECT_LT(pse.interval.low, pse.value) << count << " people, " << n << " answers, table " << table;
    held += pse.interval.low <= kPse && kPse <= pse.interval.high ? 1 : 0;
  }
  return static_cast<double>(held) / tables;
}

TEST(Group, OfFewPeopleHasAnIntervalThatHoldsTheirPse) {
  for (const int count : {2, 3, 4, 6}) {
    for (const double n : {3.0, 20.0}) {
      EXPECT_GE(coverageOfPse(count, n, 30), 0.86) << count << " people, " << n << " answers";
    }
  }
}

}  // namespace
}  // namespace haptolith
