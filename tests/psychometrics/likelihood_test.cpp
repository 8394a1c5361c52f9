#include "haptolith/psychometrics/likelihood.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace haptolith {
namespace {

// Responses of a simulated study of the paper's friction design; numbers from brute_force.py.
const std::vector<Level> kLevels{{0.6, 2, 24}, {0.648, 4, 24}, {0.735, 8, 24}, {1, 18, 24}, {1.21, 22, 24}};

TEST(Likelihood, IsTheBetaBinomialsByLogGamma) {
  EXPECT_NEAR(logLikelihood(0, 24, 0.1, 0.05), -2.45483750327071, 1e-9);
  EXPECT_NEAR(logLikelihood(7, 24, 0.4, 0.05), -15.091310699706582, 1e-9);
  EXPECT_NEAR(logLikelihood(24, 24, 0.97, 0.05), -0.7104437930918266, 1e-9);
  EXPECT_NEAR(logLikelihood(7, 24, 0.4, 0.3), -15.253776410574428, 1e-9);
  EXPECT_NEAR(logLikelihood(7, 24, 0.4, 0.9), -17.384270039634586, 1e-9);
  EXPECT_NEAR(logLikelihood(24, 24, 0.97, 0.9), -0.054506496806480786, 1e-9);
}

TEST(Likelihood, WithoutOverdispersionIsTheBinomials) {
  EXPECT_NEAR(logLikelihood(7, 24, 0.4, 0), 7 * std::log(0.4) + 17 * std::log(0.6), 1e-12);
  EXPECT_NEAR(logLikelihood(7, 24, 0.4, 1e-6), logLikelihood(7, 24, 0.4, 0), 1e-6);
  EXPECT_NEAR(logLikelihood(kLevels, weberFunction(0.835, 0.29), 0), -53.447611528089425, 1e-9);
}

TEST(Likelihood, SumsToOneOverAllAnswers) {
  for (const double eta : {0.0, 0.2, 0.99}) {
    double sum = 0;
    for (int k = 0; k <= 5; ++k) {
      sum += std::exp(logLikelihood(k, 5, 0.3, eta)) * std::tgamma(6) / std::tgamma(k + 1) / std::tgamma(6 - k);
    }
    EXPECT_NEAR(sum, 1, 1e-12) << eta;
  }
}

TEST(Likelihood, OfManyAnswersIsTheSameByGammaFunctions) {
  for (const double eta : {1e-4, 0.05, 0.8}) {
    // Answer by answer: the probability of the next positive one is (psi (1 - s) + k s) / (1 - s + n s), s = eta^2.
    const double s = eta * eta;
    double sum = 0;
    for (int i = 0; i < 100; ++i) {
      const double share = i < 70 ? 0.6 * (1 - s) + i * s : 0.4 * (1 - s) + (i - 70) * s;
      sum += std::log(share / (1 - s + i * s));
    }
    EXPECT_NEAR(logLikelihood(70, 100, 0.6, eta), sum, 1e-6) << eta;
  }
}

TEST(Likelihood, OfManyAnswersDoesNotUnderflow) {
  EXPECT_NEAR(logLikelihood(3000, 6000, 0.5, 1e-9), 6000 * std::log(0.5), 1e-6);
}

TEST(Likelihood, WhatIsExcludedIsImpossible) {
  EXPECT_EQ(logLikelihood(1, 2, 0, 0), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(logLikelihood(1, 2, 0, 0.3), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(logLikelihood(0, 2, 0, 0), 0);
}

TEST(Deviance, IsNoughtWhenEveryLevelIsMetExactly) {
  PsychometricFunction function;  // 0 to 1 about 0
  const std::vector<Level> exact{{0, 5, 10}};
  EXPECT_NEAR(devianceOf(exact, function), 0, 1e-12);
  const std::vector<Level> worse{{0, 6, 10}};
  EXPECT_NEAR(devianceOf(worse, function), 2 * (6 * std::log(0.6 / 0.5) + 4 * std::log(0.4 / 0.5)), 1e-12);
}

TEST(Deviance, IsNeverBelow0) {
  PsychometricFunction function;
  function.threshold = 0.3;
  for (const double n : {10.0, 1e4, 1e9}) {
    for (const double x : {-3.0, -0.2, 0.3, 0.9, 40.0}) {
      const std::vector<Level> level{{x, std::round(n * probability(function, x)), n}};
      EXPECT_GE(devianceOf(level, function), 0) << n << " " << x;
      EXPECT_LT(devianceOf(level, function), 1) << n << " " << x;
    }
  }
  function.lapse = function.guess = 0;
  EXPECT_EQ(devianceOf(std::vector<Level>{{1e3, 9, 10}}, function), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace haptolith
