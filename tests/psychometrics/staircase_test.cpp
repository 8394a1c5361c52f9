#include "haptolith/psychometrics/adaptive/staircase.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/math/random.h"
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

/// The sides of the first `count` trials, answered alternately: above the reference, 4, or below it.
std::vector<bool> sidesOf(std::uint64_t seed, std::size_t count) {
  const auto staircase = makeStaircase({.reversals = 200, .most_trials = 1000, .seed = seed}, {1, 2, 3, 5, 6, 7}, 4);
  std::vector<bool> above;
  above.reserve(count);
  while (above.size() < count) {
    const double x = staircase->next().value();
    above.push_back(x > 4);
    staircase->answer(x, above.size() % 2 == 0);
  }
  return above;
}

TEST(Staircase, TheSideOfATrialDoesNotFollowFromThoseBefore) {
  constexpr std::size_t kPeople = 200, kTrials = 40;
  std::vector<int> changes(kTrials), uppers(kTrials);
  for (std::size_t person = 0; person < kPeople; ++person) {
    const std::vector<bool> above = sidesOf(person, kTrials);
    for (std::size_t i = 0; i < kTrials; ++i) {
      changes[i] += i > 0 && above[i] != above[i - 1] ? 1 : 0;
      uppers[i] += above[i] ? 1 : 0;
    }
  }
  for (std::size_t i = 1; i < kTrials; ++i) {
    EXPECT_NEAR(changes[i], 0.55 * kPeople, 0.18 * kPeople) << i;  // five standard deviations
    EXPECT_NEAR(uppers[i], 0.5 * kPeople, 0.18 * kPeople) << i;
  }
}

TEST(Staircase, BothSidesHaveAboutEquallyManyTrials) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    int balance = 0;
    for (const bool above : sidesOf(seed, 60)) {
      balance += above ? 1 : -1;
      EXPECT_LE(std::abs(balance), 4) << seed;
    }
  }
}

TEST(Staircase, SeveralOfASideEachGoTheirOwnWay) {
  constexpr int kEach = 2;
  const auto staircase = makeStaircase({.staircases = kEach, .first_step = 1, .reversals = 3, .uncounted_reversals = 1},
                                       {1, 2, 3, 4, 6, 7, 8, 9}, 5);
  std::map<double, int> shown;
  int trials = 0;
  for (; staircase->next(); ++trials) {
    const double x = *staircase->next();
    ++shown[x];
    const bool right = std::abs(x - 5) > 1.5;  // each goes to the last level but one and turns there
    staircase->answer(x, right == (x > 5));
  }
  // Two right answers lead each of the four from 4 to 3, 2 and 1 away; there a wrong one leads back, and so on.
  EXPECT_EQ(shown[1], 2 * kEach);
  EXPECT_EQ(shown[9], 2 * kEach);
  EXPECT_EQ(trials, 2 * kEach * (2 + 2 + 2 + 1 + 2 + 1));
  EXPECT_NEAR(staircase->estimate()->threshold, 5, 1e-12);
}

TEST(Staircase, ThatLookForEqualityBeginAtBothEnds) {
  const auto staircase = makeStaircase(
      {.target = StaircaseTarget::kEquality, .staircases = 2, .down = 1, .first_step = 1}, {1, 2, 3, 4}, 2);
  std::set<double> shown;
  for (int i = 0; i < 12; ++i) {
    shown.insert(*staircase->next());
    staircase->answer(*staircase->next(), *staircase->next() > 2.5);
  }
  EXPECT_TRUE(shown.contains(1));
  EXPECT_TRUE(shown.contains(4));
}

TEST(Staircase, GoesOnWhereItWasWhenToldTheAnswersAgain) {
  std::mt19937_64 random(3);
  const StaircaseOptions options{.staircases = 2, .seed = 9};
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

// Earlier versions drew the turns otherwise: a block that such a version has begun still continues in place.
TEST(Staircase, AnswersOutOfTurnBelongToTheirSide) {
  const auto staircase = makeStaircase({.first_step = 1}, {1, 2, 3, 5, 6, 7}, 4);
  for (const double x : {7.0, 7.0, 6.0, 6.0, 1.0, 1.0}) {
    staircase->answer(x, x > 4);
  }
  std::set<double> shown;
  for (int i = 0; i < 12; ++i) {
    shown.insert(*staircase->next());
    staircase->answer(*staircase->next(), *staircase->next() > 4);
  }
  EXPECT_EQ(shown, (std::set<double>{2, 3, 5}));
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
  EXPECT_THROW((void)makeStaircase({.staircases = 0}, {1, 2}, 0), InvalidParameter);
  EXPECT_THROW((void)makeStaircase({.reversals = 2}, {1, 2}, 0), InvalidParameter);
  EXPECT_THROW((void)makeStaircase({}, {1}, 0), InvalidParameter);
  EXPECT_THROW((void)makeStaircase({}, {2, 1}, 0), InvalidParameter);
  EXPECT_THROW((void)makeStaircase({.log_axis = true}, {0, 1}, 0.5), InvalidParameter);
  EXPECT_THROW(makeStaircase({}, {1, 2}, 0)->answer(1.5, true), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
