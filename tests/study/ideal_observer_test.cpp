#include "haptolith/study/perception/ideal_observer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr Sense kSense{.weber_fraction = 0.3, .threshold = 0.01};
constexpr std::array kOneSense{kSense};

/// Magnitudes that are proportional to x^power, without scatter.
std::vector<SensedStimulus> powerLaw(double power) {
  std::vector<SensedStimulus> stimuli;
  for (const double x : {0.6, 0.648, 0.735, 0.835, 1.0, 1.21}) {
    const double magnitude = 10 * std::pow(x, power);
    stimuli.push_back({.x = x, .magnitudes = {{magnitude}, {magnitude}}});
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
  const Discrimination found = discriminate(powerLaw(1), 3, kOneSense);
  EXPECT_NEAR(found.weber_fraction, 0.3, 0.01);
  EXPECT_EQ(found.weights, std::vector<double>{1});
  EXPECT_EQ(found.jnds[3], 0);
  EXPECT_NEAR(found.jnds[5], std::log(1.21 / 0.835) / std::log(1.3), 1e-4);
  ASSERT_EQ(found.steps.size(), 5U);
  EXPECT_NEAR(found.steps[0], std::log(0.648 / 0.6) / std::log(1.3), 1e-4);
}

TEST(Discrimination, SteeperCuesTellFinerDifferences) {
  // ln(1 + w) of x is that of the cue over its power.
  EXPECT_NEAR(discriminate(powerLaw(2), 3, kOneSense).weber_fraction, std::sqrt(1.3) - 1, 0.01);
}

TEST(Discrimination, LearnsThatACueFalls) {
  const Discrimination found = discriminate(powerLaw(-1), 3, kOneSense);
  EXPECT_EQ(found.weights, std::vector<double>{-1});
  EXPECT_NEAR(found.weber_fraction, 0.3, 0.01);
  EXPECT_GT(found.jnds[5], 0);
}

TEST(Discrimination, FindsNoWeberFractionWhereNothingIsToBeFelt) {
  EXPECT_TRUE(std::isinf(discriminate(powerLaw(0), 3, kOneSense).weber_fraction));
}

TEST(Discrimination, OfTwoIndependentCuesAddsTheirSquares) {
  // Two cues that both are the stimulus: d grows by sqrt(2), and ln(1 + w) falls by as much.
  std::vector<SensedStimulus> stimuli = powerLaw(1);
  for (SensedStimulus& stimulus : stimuli) {
    for (std::vector<double>& exploration : stimulus.magnitudes) {
      exploration.push_back(exploration.front());
    }
  }
  const Discrimination found = discriminate(stimuli, 3, std::array{kSense, kSense});
  EXPECT_NEAR(found.weights[0], std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(found.jnds[5], std::sqrt(2) * std::log(1.21 / 0.835) / std::log(1.3), 1e-4);
  EXPECT_NEAR(found.weber_fraction, std::exp(std::log(1.3) / std::sqrt(2)) - 1, 0.01);
}

TEST(Discrimination, TakesAwayWhatTwoCuesScatterTogether) {
  // The second cue says nothing of the stimulus but all of what scatters in the first.
  std::vector<SensedStimulus> stimuli = powerLaw(1);
  for (SensedStimulus& stimulus : stimuli) {
    const double magnitude = stimulus.magnitudes.front().front();
    stimulus.magnitudes = {{magnitude / 8, 1. / 8}, {magnitude * 8, 8}};
  }
  const double alone = [&] {
    std::vector<SensedStimulus> first = stimuli;
    for (SensedStimulus& stimulus : first) {
      for (std::vector<double>& exploration : stimulus.magnitudes) {
        exploration.pop_back();
      }
    }
    return discriminate(first, 3, kOneSense).jnds[5];
  }();
  const Discrimination both = discriminate(stimuli, 3, std::array{kSense, kSense});
  EXPECT_LT(both.weights[1], 0);
  // The rest is the noise of both senses.
  EXPECT_NEAR(both.jnds[5], std::log(1.21 / 0.835) / std::log(1.3) / std::sqrt(2), 0.01);
  EXPECT_LT(alone, 0.5 * both.jnds[5]);
}

/// The interval is tested by simulation: 100 studies of 15 explorations that scatter by a JND.
TEST(Discrimination, HoldsTheTrueWeberFractionInItsInterval) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const double scatter = std::log(1.3);
  const auto study = [&](int explorations) {
    std::vector<SensedStimulus> stimuli = powerLaw(1);
    for (SensedStimulus& stimulus : stimuli) {
      const double magnitude = stimulus.magnitudes.front().front();
      stimulus.magnitudes.clear();
      for (int i = 0; i < explorations; ++i) {
        stimulus.magnitudes.push_back({magnitude * std::exp(scatter * normal(random))});
      }
    }
    return stimuli;
  };
  const double truth = discriminate(study(100'000), 3, kOneSense).weber_fraction;
  int held = 0;
  constexpr int kStudies = 100;
  for (int i = 0; i < kStudies; ++i) {
    const Discrimination found = discriminate(study(15), 3, kOneSense, {.resamplings = 60, .seed = 1});
    held += static_cast<int>(found.interval.low <= truth && truth <= found.interval.high);
  }
  EXPECT_GT(held, 0.85 * kStudies);
  EXPECT_LT(held, kStudies);
  RecordProperty("held", held);
}

TEST(Discrimination, RefusesNonsense) {
  EXPECT_THROW((void)discriminate(powerLaw(1), 3, std::array{kSense, kSense}), InvalidParameter);
  EXPECT_THROW((void)discriminate(powerLaw(1), 6, kOneSense), InvalidParameter);
  EXPECT_THROW((void)discriminate(std::vector<SensedStimulus>(2), 0, kOneSense), InvalidParameter);
}

/// Explorations of one cue whose sensations scatter by `scatter_jnds`.
SensedStimulus scattering(double magnitude, int explorations, int cues, double scatter_jnds, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  SensedStimulus stimulus;
  for (int i = 0; i < explorations; ++i) {
    std::vector<double>& magnitudes = stimulus.magnitudes.emplace_back();
    for (int cue = 0; cue < cues; ++cue) {
      magnitudes.push_back(magnitude * std::pow(1.3, scatter_jnds * normal(random)));
    }
  }
  return stimulus;
}

TEST(PairDiscrimination, OfOneCueIsItsDiscriminability) {
  const SensedStimulus a{.x = 0, .magnitudes = {{10}, {10}, {10}, {10}}},
      b{.x = 0, .magnitudes = {{13}, {13}, {13}, {13}}};
  EXPECT_NEAR(discriminatePair(a, b, kOneSense).jnds, 1, 1e-5);
  EXPECT_NEAR(discriminatePair(b, a, kOneSense).jnds, 1, 1e-5) << "the observer learns which way the cue goes";
  EXPECT_EQ(discriminatePair(a, a, kOneSense).jnds, 0);
}

TEST(PairDiscrimination, FindsNothingInNoise) {
  std::mt19937_64 random(3);
  const std::vector<Sense> senses(5, kSense);
  double sum = 0;
  constexpr int kStudies = 400;
  for (int study = 0; study < kStudies; ++study) {
    const SensedStimulus a = scattering(10, 16, 5, 1, random), b = scattering(10, 16, 5, 1, random);
    sum += discriminatePair(a, b, senses).jnds;
  }
  EXPECT_NEAR(sum / kStudies, 0, 0.06);
}

TEST(PairDiscrimination, HoldsTheTrueDistanceInItsInterval) {
  std::mt19937_64 random(4);
  const double truth = 2 / std::sqrt(1 + 0.5);  // 2 JNDs, each stimulus scattering by a half
  int held = 0;
  constexpr int kStudies = 100;
  for (int study = 0; study < kStudies; ++study) {
    const SensedStimulus a = scattering(10, 16, 1, 0.5, random), b = scattering(16.9, 16, 1, 0.5, random);
    const PairDiscrimination found = discriminatePair(a, b, kOneSense, {.resamplings = 100});
    held += static_cast<int>(found.interval.low <= truth && truth <= found.interval.high);
  }
  EXPECT_GT(held, 0.8 * kStudies);
  RecordProperty("held", held);
}

TEST(PairDiscrimination, RefusesNonsense) {
  const SensedStimulus few{.x = 0, .magnitudes = {{10}, {10}, {10}}},
      enough{.x = 0, .magnitudes = {{10}, {10}, {10}, {10}}};
  EXPECT_THROW((void)discriminatePair(few, enough, kOneSense), InvalidParameter);
  EXPECT_THROW((void)discriminatePair(enough, enough, std::array{kSense, kSense}), InvalidParameter);
}

TEST(DPrime, IsTheRootOfTwoOfAJnd) {
  // A JND is discriminated in 84 % of two-interval trials, whose d' is sqrt(2) z(0.84) by definition.
  EXPECT_NEAR(dPrime(1), 1.414, 1e-3);
  EXPECT_EQ(dPrime(0), 0);
}

TEST(Cues, HaveSensesThatMakeSense) {
  EXPECT_FALSE(seenCues().empty());
  for (const SeenCue& cue : seenCues()) {
    EXPECT_LT(cue.sense.weber_fraction, 0.11) << cue.name << ": the eye is finer than the hand";
    EXPECT_GT(cue.sense.threshold, 0) << cue.name;
  }
  EXPECT_FALSE(cues().empty());
  for (const Cue& cue : cues()) {
    EXPECT_GT(cue.sense.weber_fraction, 0.05) << cue.name;
    EXPECT_LT(cue.sense.weber_fraction, 0.5) << cue.name;
    EXPECT_GT(cue.sense.threshold, 0) << cue.name;
  }
}

}  // namespace
}  // namespace haptolith
