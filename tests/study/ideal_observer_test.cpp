#include "haptolith/study/ideal_observer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr Sense kSense{.weber_fraction = 0.3, .threshold = 0.01};

/// Magnitudes that are proportional to x^power, without scatter.
std::vector<FeltStimulus> powerLaw(double power) {
  std::vector<FeltStimulus> stimuli;
  for (const double x : {0.6, 0.648, 0.735, 0.835, 1.0, 1.21}) {
    const double magnitude = 10 * std::pow(x, power);
    stimuli.push_back({.x = x, .magnitudes = {magnitude, magnitude}});
  }
  return stimuli;
}

TEST(Sensation, CountsThresholdsNearNothingAndWeberFractionsAbove) {
  EXPECT_EQ(sensation(0, kSense), 0);
  EXPECT_NEAR(sensation(0.001, kSense), 0.1, 1e-3);
  EXPECT_NEAR(sensation(13, kSense) - sensation(10, kSense), 1, 1e-5);
  EXPECT_EQ(sensation(-2, kSense), -sensation(2, kSense));
}

TEST(Discriminability, IsAJndForAWeberFractionWithoutScatter) {
  const std::vector<double> a{10, 10}, b{13, 13};
  EXPECT_NEAR(discriminability(a, b, kSense), 1, 1e-5);
  EXPECT_NEAR(discriminability(b, a, kSense), -1, 1e-5);
}

TEST(Discriminability, ShrinksWithTheScatterOfExplorations) {
  // s differs by 2 around the same means: the variance of two such values is 2 on each side, d = 1 / sqrt(1 + 2 + 2).
  const std::vector<double> a{10 / 1.3, 10 * 1.3}, b{10, 10 * 1.69};
  EXPECT_NEAR(discriminability(a, b, kSense), 1 / std::sqrt(5.0), 1e-5);
  EXPECT_THROW((void)discriminability(a, std::vector<double>{1}, kSense), InvalidParameter);
}

TEST(Discrimination, ShowsTheSensesWeberFractionWhereTheCueIsTheStimulus) {
  const Discrimination found = discriminate(powerLaw(1), 3, kSense);
  EXPECT_NEAR(found.weber_fraction, 0.3, 0.01);
  EXPECT_TRUE(found.rises);
  EXPECT_EQ(found.jnds[3], 0);
  EXPECT_NEAR(found.jnds[5], std::log(1.21 / 0.835) / std::log(1.3), 1e-4);
  ASSERT_EQ(found.steps.size(), 5U);
  EXPECT_NEAR(found.steps[0], std::log(0.648 / 0.6) / std::log(1.3), 1e-4);
}

TEST(Discrimination, SteeperCuesTellFinerDifferences) {
  // ln(1 + w) of x is that of the cue over its power.
  EXPECT_NEAR(discriminate(powerLaw(2), 3, kSense).weber_fraction, std::sqrt(1.3) - 1, 0.01);
}

TEST(Discrimination, LearnsThatACueFalls) {
  const Discrimination found = discriminate(powerLaw(-1), 3, kSense);
  EXPECT_FALSE(found.rises);
  EXPECT_NEAR(found.weber_fraction, 0.3, 0.01);
  EXPECT_GT(found.jnds[5], 0);
}

TEST(Discrimination, FindsNoWeberFractionWhereNothingIsToBeFelt) {
  EXPECT_TRUE(std::isinf(discriminate(powerLaw(0), 3, kSense).weber_fraction));
}

TEST(Discrimination, RefusesNonsense) {
  EXPECT_THROW((void)discriminate(powerLaw(1), 6, kSense), InvalidParameter);
  EXPECT_THROW((void)discriminate(std::vector<FeltStimulus>(2), 0, kSense), InvalidParameter);
}

TEST(Cues, HaveSensesThatMakeSense) {
  EXPECT_FALSE(cues().empty());
  for (const Cue& cue : cues()) {
    EXPECT_GT(cue.sense.weber_fraction, 0.05) << cue.name;
    EXPECT_LT(cue.sense.weber_fraction, 0.5) << cue.name;
    EXPECT_GT(cue.sense.threshold, 0) << cue.name;
  }
}

}  // namespace
}  // namespace haptolith
