// Maximum likelihood: is the maximum found, and do the intervals hold what they say?

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/goodness_of_fit.h"
#include "haptolith/psychometrics/likelihood.h"

namespace haptolith {
namespace {

constexpr std::array kStimuli{0.25, 5 / 12.0, 7 / 12.0, 0.75, 11 / 12.0, 13 / 12.0, 1.25, 17 / 12.0, 19 / 12.0, 1.75};

std::vector<Level> tenLevels(const std::array<double, 10>& positive) {
  std::vector<Level> levels;
  for (std::size_t i = 0; i < kStimuli.size(); ++i) {
    levels.push_back({kStimuli[i], positive[i], 10});
  }
  return levels;
}

FitOptions twoAlternatives() {
  return {.design = Design::kForcedChoice, .overdispersion = 0, .simulations = 0};
}

TEST(MaximumLikelihood, FindsANarrowPeakBesideAWideOne) {
  const std::vector<Level> levels = tenLevels({4, 6, 4, 8, 9, 8, 8, 7, 9, 10});
  FitOptions options = twoAlternatives();
  options.overdispersion.reset();
  const Fit fit = fitMaximumLikelihood(levels, options);
  // The wide one, at threshold 1.05, width 1.92 and no lapses, has 1.17 less.
  EXPECT_NEAR(fit.threshold.value, 0.70, 0.03);
  EXPECT_LT(fit.width.value, 0.25);
  EXPECT_NEAR(fit.lapse.value, 0.149, 0.005);
  const PsychometricFunction wide{.threshold = 1.046, .width = 1.92, .guess = 0.5};
  EXPECT_GT(fit.log_likelihood, logLikelihood(levels, wide, 0) + 1.1);
  // AIC, BIC and p of every method rest on the same point.
  EXPECT_NEAR(fitPsychometric(levels, options).log_likelihood, fit.log_likelihood, 1e-4);
}

/// The largest log-likelihood of each set among the points of a dense grid of threshold, width and lapse rate.
std::vector<double> densestOf(const std::vector<std::vector<Level>>& sets) {
  std::vector<double> best(sets.size(), -1e9);
  std::vector<double> hit(kStimuli.size());
  std::vector<double> miss(kStimuli.size());
  for (double threshold = -0.5; threshold <= 2.5; threshold += 0.02) {
    for (double width = 1 / 6.0; width <= 4.5; width *= 1.05) {
      for (double lapse = 0; lapse <= 0.5; lapse += 0.0125) {
        const PsychometricFunction function{.threshold = threshold, .width = width, .guess = 0.5, .lapse = lapse};
        for (std::size_t i = 0; i < kStimuli.size(); ++i) {
          const double psi = probability(function, kStimuli[i]);
          hit[i] = std::log(psi);
          miss[i] = std::log(std::max(1 - psi, 1e-300));
        }
        for (std::size_t set = 0; set < sets.size(); ++set) {
          double sum = 0;
          for (std::size_t i = 0; i < kStimuli.size(); ++i) {
            sum += sets[set][i].k * hit[i] + (10 - sets[set][i].k) * miss[i];
          }
          best[set] = std::max(best[set], sum);
        }
      }
    }
  }
  return best;
}

TEST(MaximumLikelihood, IsNeverBelowADenseSearch) {
  constexpr int kSets = 60;
  const PsychometricFunction truth{.threshold = 1, .width = 1, .guess = 0.5, .lapse = 0.05};
  std::mt19937_64 random(60);
  std::vector<std::vector<Level>> sets;
  for (int i = 0; i < kSets; ++i) {
    sets.push_back(simulatedAnswers(tenLevels({}), truth, random));
  }
  const std::vector<double> dense = densestOf(sets);
  for (int i = 0; i < kSets; ++i) {
    const Fit fit = fitPsychometric(sets[i], twoAlternatives());
    EXPECT_GE(fit.log_likelihood, dense[i] - 1e-6) << i;
    EXPECT_LE(fit.log_likelihood, dense[i] + 0.1) << i << ": the search is not dense enough";
  }
}

TEST(MaximumLikelihood, IntervalsHoldTheirOwnEstimate) {
  // Answers that scatter more than binomial ones.
  const std::vector<Level> levels{{0.25, 2, 40},  {0.46, 12, 40}, {0.68, 3, 40},  {0.89, 25, 40},
                                  {1.11, 12, 40}, {1.32, 38, 40}, {1.54, 30, 40}, {1.75, 40, 40}};
  const FitOptions options{.lapse = 0, .guess = 0, .simulations = 0};
  const Fit fit = fitMaximumLikelihood(levels, options);
  EXPECT_NEAR(fit.overdispersion.value, 0.4071, 1e-3);
  EXPECT_LT(fit.overdispersion.interval.low, 0.3);
  EXPECT_GT(fit.overdispersion.interval.high, 0.5);
  const Fit bayesian = fitPsychometric(levels, options);
  EXPECT_LT(fit.threshold.interval.low, bayesian.threshold.interval.low + 0.03);
  EXPECT_GT(fit.threshold.interval.high, bayesian.threshold.interval.high - 0.03);
}

TEST(MaximumLikelihood, OfManyAnswersHasTheIntervalOfTheCurvature) {
  // The width does not matter: the interval of a share p of n, p +- 1.96 sqrt(p (1 - p)/n), in the lapse rate.
  const std::vector<Level> levels{{-5, 0, 100000}, {0.1, 9, 10}, {5, 90000, 100000}};
  FitOptions options{.threshold = 0, .guess = 0, .overdispersion = 0, .simulations = 0};
  options.lapse.reset();
  const Fit fit = fitMaximumLikelihood(levels, options);
  const double error = std::sqrt(0.9 * 0.1 / 100000);
  EXPECT_NEAR(fit.lapse.value, 0.1, 1e-5);
  EXPECT_NEAR(fit.lapse.interval.low, 0.1 - 1.96 * error, 0.05 * error);
  EXPECT_NEAR(fit.lapse.interval.high, 0.1 + 1.96 * error, 0.05 * error);
}

TEST(SimulatedAnswers, ScatterAsTheBetaBinomial) {
  constexpr int kSets = 4000;
  const PsychometricFunction half{.threshold = 1, .width = 1};
  const std::vector<Level> levels{{1, 0, 40}};
  for (const double eta : {0.0, 0.3}) {
    std::mt19937_64 random(3);
    double sum = 0;
    double squares = 0;
    for (int i = 0; i < kSets; ++i) {
      const double share = simulatedAnswers(levels, half, random, eta).front().k / 40;
      sum += share / kSets;
      squares += share * share / kSets;
    }
    // psi (1 - psi) (1/n + (1 - 1/n) eta^2)
    const double variance = 0.25 * (1.0 / 40 + (1 - 1.0 / 40) * eta * eta);
    EXPECT_NEAR(sum, 0.5, 0.015) << eta;
    EXPECT_NEAR(squares - sum * sum, variance, 0.08 * variance) << eta;
  }
}

TEST(GoodnessOfFit, OfAModelWithOverdispersionExpectsIt) {
  // Answers that no binomial function gives, but one with much overdispersion does.
  const std::vector<Level> levels{{0.25, 2, 40},  {0.46, 12, 40}, {0.68, 3, 40},  {0.89, 25, 40},
                                  {1.11, 12, 40}, {1.32, 38, 40}, {1.54, 30, 40}, {1.75, 40, 40}};
  FitOptions options{.lapse = 0, .guess = 0, .simulations = 200};
  EXPECT_GT(fitPsychometric(levels, options).p_value, 0.1);
  options.overdispersion = 0;
  EXPECT_LT(fitPsychometric(levels, options).p_value, 0.01);
}

}  // namespace
}  // namespace haptolith
