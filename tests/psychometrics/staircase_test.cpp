#include "haptolith/psychometrics/staircase.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/core/random.h"
#include "haptolith/psychometrics/psychometric_function.h"

namespace haptolith {
namespace {

using testing::DoubleEq;
using testing::Optional;

bool answerOf(const PsychometricFunction& truth, double x, std::mt19937_64& random) {
  return (uniformSigned(random) + 1) / 2 < probability(truth, x);
}

/// Levels in steps of 8 % on both sides of 1.
std::vector<double> fineLevels() {
  std::vector<double> levels;
  for (int i = -12; i <= 12; ++i) {
    if (i != 0) {
      levels.push_back(std::exp(0.08 * i));
    }
  }
  return levels;
}

/// Runs to its end with a simulated person; gives the number of trials.
int runThrough(AdaptiveProcedure& procedure, const PsychometricFunction& truth, std::mt19937_64& random) {
  int trials = 0;
  while (const std::optional<double> x = procedure.next()) {
    procedure.answer(*x, answerOf(truth, *x, random));
    ++trials;
  }
  return trials;
}

TEST(Staircase, TwoDownOneUpStepsAsLevittsTable) {
  const auto staircase = makeStaircase({.first_step = 1, .reversals = 4, .uncounted_reversals = 1}, {2, 3, 4, 5}, 1);
  // One side only. Two right answers lead towards the reference, one wrong answer away.
  const std::vector<std::pair<double, bool>> course{{5, true}, {5, true}, {4, true},  {4, true},  {3, true}, {3, false},
                                                    {4, true}, {4, true}, {3, false}, {4, false}, {5, true}, {5, true}};
  for (const auto& [x, right] : course) {
    EXPECT_THAT(staircase->next(), Optional(DoubleEq(x)));
    staircase->answer(x, right);
  }
  EXPECT_EQ(staircase->next(), std::nullopt);  // reversals at 3, 4, 3, 5
  // (4 + 3 + 5)/3 is 3 above the reference, where a Gaussian of this JND gives 2^(-1/2).
  EXPECT_NEAR(staircase->estimate()->jnd, 3 / 0.5449521356, 1e-6);
  EXPECT_EQ(staircase->estimate()->threshold, 1);
}

TEST(Staircase, FirstStepsAreLargeUntilTheFirstReversal) {
  const auto staircase =
      makeStaircase({.target = StaircaseTarget::kEquality, .down = 1, .first_step = 3}, {1, 2, 3, 4, 5, 6, 7, 8}, 4);
  staircase->answer(*staircase->next(), true);  // 8
  EXPECT_THAT(staircase->next(), Optional(5));
  staircase->answer(5, true);
  EXPECT_THAT(staircase->next(), Optional(2));
  staircase->answer(2, false);
  EXPECT_THAT(staircase->next(), Optional(3));
}

TEST(Staircase, OneUpOneDownFindsThePointOfEquality) {
  std::mt19937_64 random(1);
  const PsychometricFunction truth = weberFunction(1.2, 0.3);
  double sum = 0;
  constexpr int kPeople = 60;
  for (int i = 0; i < kPeople; ++i) {
    const auto staircase = makeStaircase({.target = StaircaseTarget::kEquality,
                                          .down = 1,
                                          .reversals = 30,
                                          .uncounted_reversals = 6,
                                          .most_trials = 200,
                                          .log_axis = true},
                                         fineLevels(), 1);
    runThrough(*staircase, truth, random);
    sum += std::log(staircase->estimate()->threshold) / kPeople;
  }
  EXPECT_NEAR(std::exp(sum), 1.2, 0.03);
}

/// Levels whose distance from 1 grows by a quarter from one to the next: a ladder that is fine where it is wanted.
std::vector<double> growingLevels() {
  std::vector<double> distances;
  for (double distance = 0.02; distance < 1; distance *= 1.25) {
    distances.push_back(distance);
    distances.push_back(-distance);
  }
  std::vector<double> levels;
  for (const double distance : distances) {
    levels.push_back(std::exp(distance));
  }
  std::ranges::sort(levels);
  return levels;
}

TEST(Staircase, OnBothSidesFindsEqualityAndJnd) {
  std::mt19937_64 random(2);
  for (const int down : {2, 3}) {
    const PsychometricFunction truth = weberFunction(1.02, 0.29);
    double sum_threshold = 0;
    double sum_jnd = 0;
    constexpr int kPeople = 60;
    for (int i = 0; i < kPeople; ++i) {
      const auto staircase = makeStaircase({.down = down,
                                            .reversals = 30,
                                            .uncounted_reversals = 6,
                                            .most_trials = 1000,
                                            .log_axis = true,
                                            .seed = std::uint64_t(i)},
                                           growingLevels(), 1);
      runThrough(*staircase, truth, random);
      sum_threshold += staircase->estimate()->threshold / kPeople;
      sum_jnd += staircase->estimate()->jnd / kPeople;
    }
    EXPECT_NEAR(sum_threshold, 1.02, 0.02) << down;
    // A staircase in steps settles a little off its share.
    EXPECT_NEAR(sum_jnd, 0.29 * 1.02, 0.15 * 0.29) << down;
  }
}

TEST(Staircase, BothSidesHaveTheirTurnInEveryPair) {
  const auto staircase = makeStaircase({.reversals = 50}, {1, 2, 3, 5, 6, 7}, 4);
  for (int pair = 0; pair < 10; ++pair) {
    double sides = 0;
    for (int i = 0; i < 2; ++i) {
      const double x = *staircase->next();
      sides += x > 4 ? 1 : -1;
      staircase->answer(x, i == 0);
    }
    EXPECT_EQ(sides, 0) << pair;
  }
}

TEST(Staircase, GoesOnWhereItWasWhenToldTheAnswersAgain) {
  std::mt19937_64 random(3);
  const StaircaseOptions options{.seed = 9};
  const auto staircase = makeStaircase(options, fineLevels(), 1);
  const auto again = makeStaircase(options, fineLevels(), 1);
  for (int i = 0; i < 25; ++i) {
    ASSERT_EQ(again->next(), staircase->next());
    const double x = *staircase->next();
    const bool positive = answerOf(weberFunction(1, 0.29), x, random);
    staircase->answer(x, positive);
    again->answer(x, positive);
  }
}

TEST(Staircase, EndsAfterSoManyTrials) {
  std::mt19937_64 random(4);
  const auto staircase = makeStaircase({.reversals = 1000, .most_trials = 33}, fineLevels(), 1);
  EXPECT_EQ(runThrough(*staircase, weberFunction(1, 0.3), random), 33);
  EXPECT_EQ(makeStaircase({}, fineLevels(), 1)->estimate(), std::nullopt);
}

TEST(Staircase, NonsenseIsRefused) {
  EXPECT_THROW((void)makeStaircase({.down = 1}, {1, 2}, 0), InvalidParameter) << "settles at chance";
  EXPECT_THROW((void)makeStaircase({.down = 0}, {1, 2}, 0), InvalidParameter);
  EXPECT_THROW((void)makeStaircase({.up = 0}, {1, 2}, 0), InvalidParameter);
  EXPECT_THROW((void)makeStaircase({.reversals = 2}, {1, 2}, 0), InvalidParameter);
  EXPECT_THROW((void)makeStaircase({}, {1}, 0), InvalidParameter);
  EXPECT_THROW((void)makeStaircase({}, {2, 1}, 0), InvalidParameter);
  EXPECT_THROW((void)makeStaircase({.log_axis = true}, {0, 1}, 0.5), InvalidParameter);
  EXPECT_THROW(makeStaircase({}, {1, 2}, 0)->answer(1.5, true), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
