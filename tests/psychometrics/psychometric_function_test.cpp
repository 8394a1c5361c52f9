#include "haptolith/psychometrics/psychometric_function.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr double kLess = 1e-12;

PsychometricFunction exampleOf(Sigmoid sigmoid) {
  return {.sigmoid = sigmoid,
          .log_axis = isAlwaysLogarithmic(sigmoid),
          .threshold = 1.7,
          .width = 0.9,
          .guess = 0.1,
          .lapse = 0.05};
}

TEST(PsychometricFunction, IsAHalfAtTheThresholdAndAWidthGoesFromFiveTo95Percent) {
  for (const auto& [name, sigmoid] : kSigmoidNames) {
    const PsychometricFunction function = exampleOf(sigmoid);
    EXPECT_NEAR(sigmoidAt(function, 1.7), 0.5, kLess) << name;
    const double x05 = stimulusAt(function, 0.05);
    const double x95 = stimulusAt(function, 0.95);
    EXPECT_NEAR(toAxis(function, x95) - toAxis(function, x05), 0.9, 1e-9) << name;
  }
}

TEST(PsychometricFunction, GoesFromTheGuessRateToOneLessTheLapseRate) {
  for (const auto& [name, sigmoid] : kSigmoidNames) {
    const PsychometricFunction function = exampleOf(sigmoid);
    const double reach = sigmoid == Sigmoid::kStudent ? 0.05 : 0.01;  // its tails are heavy
    EXPECT_NEAR(probability(function, 1e-9), 0.1, reach) << name;
    EXPECT_NEAR(probability(function, 1e3), 0.95, sigmoid == Sigmoid::kStudent ? 1e-4 : kLess) << name;
    EXPECT_NEAR(probability(function, 1.7), 0.1 + 0.85 / 2, kLess) << name;
  }
}

TEST(PsychometricFunction, NeverDecreases) {
  for (const auto& [name, sigmoid] : kSigmoidNames) {
    const PsychometricFunction function = exampleOf(sigmoid);
    double before = 0;
    for (double x = 0.01; x < 20; x *= 1.05) {
      EXPECT_GE(probability(function, x), before) << name << " at " << x;
      before = probability(function, x);
    }
  }
}

TEST(PsychometricFunction, StimulusAtIsItsInverse) {
  for (const auto& [name, sigmoid] : kSigmoidNames) {
    const PsychometricFunction function = exampleOf(sigmoid);
    for (const double share : {0.001, 0.3, 0.5, 0.75, 0.999}) {
      EXPECT_NEAR(sigmoidAt(function, stimulusAt(function, share)), share, 1e-12) << name;
    }
  }
}

TEST(PsychometricFunction, LogisticAndGumbelAreTheTextbooks) {
  // Logistic: 1/(1 + exp(-(x - m)/s)) is 0.95 at m + s ln 19.
  const PsychometricFunction logistic{.sigmoid = Sigmoid::kLogistic, .threshold = 2, .width = 2 * 0.4 * std::log(19.0)};
  EXPECT_NEAR(sigmoidAt(logistic, 2.5), 1 / (1 + std::exp(-0.5 / 0.4)), kLess);
  // Weibull: 1 - exp(-(x/scale)^shape).
  const double scale = 3;
  const double shape = 2.2;
  const auto at = [&](double share) { return scale * std::pow(-std::log(1 - share), 1 / shape); };
  const PsychometricFunction weibull{
      .sigmoid = Sigmoid::kWeibull, .log_axis = true, .threshold = at(0.5), .width = std::log(at(0.95) / at(0.05))};
  EXPECT_NEAR(sigmoidAt(weibull, 2.5), 1 - std::exp(-std::pow(2.5 / scale, shape)), kLess);
}

TEST(PsychometricFunction, StudentAndReversedGumbelArePsignifits) {
  // Student's t with one degree of freedom: 1/2 + atan(z)/pi, 0.95 at z = tan(0.45 pi).
  const double scale = 0.4;
  const PsychometricFunction student{
      .sigmoid = Sigmoid::kStudent, .threshold = 2, .width = 2 * scale * std::tan(0.45 * std::numbers::pi)};
  EXPECT_NEAR(sigmoidAt(student, 2.7), 0.5 + std::atan(0.7 / scale) / std::numbers::pi, kLess);
  // Gumbel of the largest value: exp(-exp(-z)).
  const auto at = [&](double share) { return 3 - scale * std::log(-std::log(share)); };
  const PsychometricFunction reversed{
      .sigmoid = Sigmoid::kReversedGumbel, .threshold = at(0.5), .width = at(0.95) - at(0.05)};
  EXPECT_NEAR(sigmoidAt(reversed, 2.5), std::exp(-std::exp(-(2.5 - 3) / scale)), kLess);
}

TEST(PsychometricFunction, FallingIsOneLessTheRisingSigmoid) {
  for (const auto& [name, sigmoid] : kSigmoidNames) {
    const PsychometricFunction rising = exampleOf(sigmoid);
    PsychometricFunction falling = rising;
    falling.falling = true;
    for (const double x : {0.9, 1.7, 2.6}) {
      EXPECT_NEAR(sigmoidAt(falling, x), 1 - sigmoidAt(rising, x), kLess) << name;
    }
    EXPECT_NEAR(sigmoidAt(falling, stimulusAt(falling, 0.3)), 0.3, kLess) << name;
    EXPECT_NEAR(probability(falling, 1.7), 0.1 + 0.85 / 2, kLess) << name;
    EXPECT_NEAR(jndOf(falling), jndOf(rising), kLess) << name;
  }
}

TEST(WeberFunction, IsThePapersInAllReadings) {
  const double p = 0.835;
  const double w = 0.29;
  for (const double x : {0.6, 0.9, 1.21}) {
    const double meant = 0.5 + 0.5 * std::erf(std::log(x / p) / (std::numbers::sqrt2 * std::log(1 + w)));
    const double printed = 0.5 + 0.5 * std::erf(std::log(x / p) / std::sqrt(2 * std::log(1 + w)));
    EXPECT_NEAR(probability(weberFunction(p, w), x), meant, kLess);
    EXPECT_NEAR(probability(weberFunction(p, w, Sigmoid::kWeberAsPrinted), x), printed, kLess);
    const double base_10 = 0.5 + 0.5 * std::erf(std::log10(x / p) / std::sqrt(2 * std::log10(1 + w)));
    EXPECT_NEAR(probability(weberFunction(p, w, Sigmoid::kWeberLog10), x), base_10, kLess);
  }
}

TEST(WeberFunction, WeberFractionAndJndAreThePapersNumbers) {
  const PsychometricFunction friction = weberFunction(0.835, 0.29);
  EXPECT_NEAR(weberFractionOf(friction), 0.29, 1e-9);
  EXPECT_NEAR(jndOf(friction), 0.24, 0.005);  // the paper's 0.24
  EXPECT_NEAR(weberParameter(Sigmoid::kWeber, friction.width), 0.29, 1e-9);
  const PsychometricFunction printed = weberFunction(0.835, 0.29, Sigmoid::kWeberAsPrinted);
  EXPECT_NEAR(weberParameter(Sigmoid::kWeberAsPrinted, printed.width), 0.29, 1e-9);
  EXPECT_NEAR(weberFractionOf(printed), std::exp(std::sqrt(std::log(1.29))) - 1, 1e-9);
  const PsychometricFunction base_10 = weberFunction(0.835, 0.29, Sigmoid::kWeberLog10);
  EXPECT_NEAR(weberParameter(Sigmoid::kWeberLog10, base_10.width), 0.29, 1e-9);
  EXPECT_NEAR(weberFractionOf(base_10), std::pow(10, std::sqrt(std::log10(1.29))) - 1, 1e-9);
}

TEST(PsychometricFunction, NamesAreFoundAgainAndOthersRefused) {
  for (const auto& [name, sigmoid] : kSigmoidNames) {
    EXPECT_EQ(sigmoidNamed(name), sigmoid);
    EXPECT_EQ(nameOf(sigmoid), name);
  }
  for (const auto& [name, design] : kDesignNames) {
    EXPECT_EQ(designNamed(name), design);
    EXPECT_EQ(nameOf(design), name);
  }
  EXPECT_EQ(designNamed("2afc"), Design::kForcedChoice);
  EXPECT_THROW((void)sigmoidNamed("normal"), InvalidParameter);
  EXPECT_THROW((void)designNamed("3afc"), InvalidParameter);
}

TEST(PsychometricFunction, NonsenseIsRefused) {
  EXPECT_THROW((void)weberFunction(0, 0.3), InvalidParameter);
  EXPECT_THROW((void)weberFunction(1, -0.3), InvalidParameter);
  EXPECT_THROW((void)weberFunction(1, 0.3, Sigmoid::kNorm), InvalidParameter);
  EXPECT_THROW((void)stimulusAt({}, 0), InvalidParameter);
  EXPECT_THROW((void)stimulusAt({}, 1), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
