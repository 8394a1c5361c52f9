#include "haptolith/psychometrics/fit.h"

#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "haptolith/core/error.h"
#include "haptolith/core/stop_asked.h"

namespace haptolith {
namespace {

// Responses of a simulated study of the paper's friction design.
constexpr double kReference = 0.835;
const std::vector<Level> kLevels{{0.6, 2, 24}, {0.648, 4, 24}, {0.735, 8, 24}, {1, 18, 24}, {1.21, 22, 24}};

FitOptions quick(FitOptions options) {
  options.simulations = 0;
  return options;
}

/// Answers that lie on `function` exactly.
std::vector<Level> cleanAnswers(const PsychometricFunction& function, const std::vector<double>& xs, double n) {
  std::vector<Level> levels;
  for (const double x : xs) {
    levels.push_back({x, std::round(n * probability(function, x)), n});
  }
  return levels;
}

TEST(Fit, FindsTheFunctionBehindCleanAnswers) {
  const std::vector<double> xs{0.5, 0.8, 1.0, 1.2, 1.5, 2, 3};
  for (const auto& [name, sigmoid] : kSigmoidNames) {
    const PsychometricFunction truth{.sigmoid = sigmoid,
                                     .log_axis = isAlwaysLogarithmic(sigmoid),
                                     .threshold = 1.2,
                                     .width = 1.1,
                                     .guess = 0.04,
                                     .lapse = 0.04};
    const Fit fit =
        fitPsychometric(cleanAnswers(truth, xs, 5000),
                        quick({.sigmoid = sigmoid, .design = Design::kEqualAsymptote, .overdispersion = 0}));
    EXPECT_NEAR(fit.threshold.value, 1.2, 0.01) << name;
    EXPECT_NEAR(fit.width.value, 1.1, 0.03) << name;
    EXPECT_NEAR(fit.lapse.value, 0.04, 0.004) << name;
    EXPECT_EQ(fit.guess.value, fit.lapse.value) << name;
    EXPECT_LT(fit.threshold.interval.low, 1.2) << name;
    EXPECT_GT(fit.threshold.interval.high, 1.2) << name;
    EXPECT_LT(fit.width.interval.low, 1.1) << name;
    EXPECT_GT(fit.width.interval.high, 1.1) << name;
  }
}

TEST(Fit, OfWeberAloneIsTheSumOfBruteForce) {
  const Fit fit = fitPsychometric(kLevels, quick(weberOptions(kReference)));
  EXPECT_NEAR(fit.w->value, 0.2951922, 2e-4);
  EXPECT_NEAR(fit.w->interval.low, 0.2210556, 4e-4);
  EXPECT_NEAR(fit.w->interval.high, 0.4282466, 4e-4);
  EXPECT_NEAR(fit.log_evidence, -58.235406, 1e-3);
  EXPECT_EQ(fit.method, FitMethod::kMedian);
  EXPECT_EQ(fit.threshold.value, kReference);
  EXPECT_EQ(fit.free_parameters, 1);
  EXPECT_NEAR(fit.jnd.value, fit.w->value * kReference, 1e-9);
  EXPECT_NEAR(fit.weber_fraction.interval.high, fit.w->interval.high, 1e-3);
}

TEST(Fit, OfThresholdAndWidthIsTheSumOfBruteForce) {
  const Fit fit = fitPsychometric(
      kLevels, quick({.lapse = 0.02, .guess = 0.02, .overdispersion = 0, .estimate = PointEstimate::kMedian}));
  EXPECT_NEAR(fit.threshold.value, 0.8612833, 2e-3);
  EXPECT_NEAR(fit.threshold.interval.low, 0.7962167, 2e-3);
  EXPECT_NEAR(fit.threshold.interval.high, 0.9344833, 2e-3);
  EXPECT_NEAR(fit.width.value, 0.717735, 3e-3);
  EXPECT_NEAR(fit.width.interval.low, 0.512805, 4e-3);
  EXPECT_NEAR(fit.width.interval.high, 1.026615, 6e-3);
  EXPECT_NEAR(fit.log_evidence, -57.530159, 2e-3);
}

TEST(Fit, AllReadingsOfThePaperAreOneCurveWithSeveralNames) {
  const Fit meant = fitPsychometric(kLevels, quick(weberOptions(kReference)));
  const Fit printed = fitPsychometric(kLevels, quick(weberOptions(kReference, Sigmoid::kWeberAsPrinted)));
  EXPECT_NEAR(printed.width.value, meant.width.value, 1e-9);
  EXPECT_NEAR(printed.weber_fraction.value, meant.weber_fraction.value, 1e-9);
  const double sigma = std::log1p(meant.w->value);
  EXPECT_NEAR(printed.w->value, std::exp(sigma * sigma) - 1, 1e-9);
  const Fit base_10 = fitPsychometric(kLevels, quick(weberOptions(kReference, Sigmoid::kWeberLog10)));
  EXPECT_NEAR(base_10.width.value, meant.width.value, 1e-9);
  EXPECT_NEAR(std::log10(1 + base_10.w->value), std::pow(sigma / std::log(10), 2), 1e-9);
}

TEST(Fit, OfAFallingFunctionMirrorsThatOfARisingOne) {
  std::vector<Level> mirrored = kLevels;
  for (Level& level : mirrored) {
    level.k = level.n - level.k;
  }
  FitOptions options = quick(weberOptions(kReference));
  options.threshold.reset();
  options.lapse = 0.01;
  const Fit rising = fitPsychometric(kLevels, options);
  options.falling = true;
  const Fit falling = fitPsychometric(mirrored, options);
  EXPECT_TRUE(falling.function.falling);
  EXPECT_NEAR(falling.threshold.value, rising.threshold.value, 1e-6);
  EXPECT_NEAR(falling.w->value, rising.w->value, 1e-6);
  EXPECT_NEAR(falling.weber_fraction.interval.high, rising.weber_fraction.interval.high, 1e-6);
  EXPECT_NEAR(falling.log_likelihood, rising.log_likelihood, 1e-6);
  EXPECT_LT(fitPsychometric(mirrored, quick(weberOptions(kReference))).log_likelihood, rising.log_likelihood - 20);
}

TEST(Fit, UnitOfTheStimulusDoesNotMatter) {
  std::vector<Level> in_other_unit = kLevels;
  for (Level& level : in_other_unit) {
    level.x *= 1000;
  }
  const FitOptions options = quick({.lapse = 0, .guess = 0, .overdispersion = 0});
  const Fit fit = fitPsychometric(kLevels, options);
  const Fit other = fitPsychometric(in_other_unit, options);
  EXPECT_NEAR(other.threshold.value, 1000 * fit.threshold.value, 1e-2);
  EXPECT_NEAR(other.width.interval.high, 1000 * fit.width.interval.high, 1e-6);
  EXPECT_NEAR(other.weber_fraction.value, fit.weber_fraction.value, 1e-5);
}

TEST(Fit, IsTheSameEveryTime) {
  const Fit one = fitPsychometric(kLevels, weberOptions(kReference));
  const Fit two = fitPsychometric(kLevels, weberOptions(kReference));
  EXPECT_EQ(one.w->value, two.w->value);
  EXPECT_EQ(one.p_value, two.p_value);
}

TEST(Fit, OfOneParameterIsQuickEnoughForALivePage) {
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 10; ++i) {
    (void)fitPsychometric(kLevels, quick(weberOptions(kReference)));
  }
  const std::chrono::duration<double> each = (std::chrono::steady_clock::now() - begin) / 10;
  EXPECT_LT(each.count(), 0.05);
}

TEST(Fit, MoreConfidenceWidensIntervals) {
  FitOptions options = quick(weberOptions(kReference));
  const Fit usual = fitPsychometric(kLevels, options);
  options.confidence = 0.68;
  const Fit narrow = fitPsychometric(kLevels, options);
  EXPECT_GT(narrow.w->interval.low, usual.w->interval.low);
  EXPECT_LT(narrow.w->interval.high, usual.w->interval.high);
}

TEST(Fit, FewerAnswersWidenIntervals) {
  std::vector<Level> few = kLevels;
  for (Level& level : few) {
    level.k /= 2;
    level.n /= 2;
  }
  const FitOptions options = quick(weberOptions(kReference));
  const Fit of_few = fitPsychometric(few, options);
  const Fit of_all = fitPsychometric(kLevels, options);
  EXPECT_GT(of_few.w->interval.high - of_few.w->interval.low, of_all.w->interval.high - of_all.w->interval.low);
}

TEST(Fit, GoodnessOfFitTellsAnswersThatNoCurveGives) {
  const Fit good = fitPsychometric(kLevels, weberOptions(kReference));
  EXPECT_GT(good.p_value, 0.2);
  EXPECT_GT(good.p_value_chi_square, 0.2);
  std::vector<Level> bad = kLevels;
  bad[1].k = 20;
  const Fit poor = fitPsychometric(bad, weberOptions(kReference));
  EXPECT_LT(poor.p_value, 0.01);
  EXPECT_LT(poor.p_value_chi_square, 0.01);
  EXPECT_GT(poor.deviance, 20);
}

TEST(Fit, OverdispersionIsFoundInAnswersThatScatterTooMuch) {
  // About a logistic from 0 to 1, but each level 15 answers of 100 too many or too few.
  std::vector<Level> levels;
  const PsychometricFunction truth{.sigmoid = Sigmoid::kLogistic, .threshold = 5, .width = 8};
  for (int i = 1; i <= 9; ++i) {
    const double k = std::round(100 * probability(truth, i)) + (i % 2 == 0 ? 15 : -15);
    levels.push_back({double(i), std::clamp(k, 0.0, 100.0), 100});
  }
  const FitOptions options = quick({.sigmoid = Sigmoid::kLogistic, .lapse = 0, .guess = 0});
  const Fit fit = fitPsychometric(levels, options);
  EXPECT_GT(fit.overdispersion.interval.low, 0.1);
  FitOptions binomial = options;
  binomial.overdispersion = 0;
  const Fit sure = fitPsychometric(levels, binomial);
  EXPECT_GT(fit.threshold.interval.high - fit.threshold.interval.low,
            2 * (sure.threshold.interval.high - sure.threshold.interval.low));
  EXPECT_GT(fit.log_evidence, sure.log_evidence + 5);
}

TEST(Fit, AnswersWithoutAnErrorStillGiveAnInterval) {
  const std::vector<Level> perfect{{0.6, 0, 3}, {0.648, 0, 3}, {0.735, 0, 3}, {1, 3, 3}, {1.21, 3, 3}};
  const Fit fit = fitPsychometric(perfect, weberOptions(kReference));
  EXPECT_GT(fit.w->value, 0);
  EXPECT_GT(fit.w->interval.high, fit.w->interval.low);
  EXPECT_LT(fit.w->interval.high, 0.5);
  EXPECT_TRUE(std::isfinite(fit.deviance));
}

TEST(Fit, BandHoldsTheCurveAndIsNarrowestWhereTheThresholdIsFixed) {
  const Fit fit = fitPsychometric(kLevels, quick(weberOptions(kReference)));
  const std::vector<double> xs{0.7, kReference, 1.1};
  const std::vector<Interval> band = credibleBand(fit, xs);
  ASSERT_EQ(band.size(), 3u);
  for (std::size_t i = 0; i < xs.size(); ++i) {
    EXPECT_LE(band[i].low, probability(fit.function, xs[i]) + 1e-12);
    EXPECT_GE(band[i].high, probability(fit.function, xs[i]) - 1e-12);
  }
  EXPECT_NEAR(band[1].high - band[1].low, 0, 1e-9);
  EXPECT_GT(band[2].high - band[2].low, 0.05);
}

TEST(MaximumLikelihood, IsWhereTheLikelihoodIsLargest) {
  FitOptions options = weberOptions(kReference);
  options.simulations = 400;
  const Fit fit = fitMaximumLikelihood(kLevels, options);
  EXPECT_EQ(fit.method, FitMethod::kMaximumLikelihood);
  const auto deviance = [&](double w) {
    Fit other = fit;
    other.function = weberFunction(kReference, w);
    double sum = 0;
    for (const Level& level : kLevels) {
      const double psi = probability(other.function, level.x);
      sum -= level.k * std::log(psi) + (level.n - level.k) * std::log(1 - psi);
    }
    return sum;
  };
  EXPECT_LT(deviance(fit.w->value), deviance(1.001 * fit.w->value));
  EXPECT_LT(deviance(fit.w->value), deviance(0.999 * fit.w->value));
  EXPECT_NEAR(fit.log_likelihood, -deviance(fit.w->value), 1e-9);
  EXPECT_NEAR(fit.aic, 2 - 2 * fit.log_likelihood, 1e-9);
  EXPECT_NEAR(fit.bic, std::log(120) - 2 * fit.log_likelihood, 1e-9);
  // The bootstrap interval is much like the credible one.
  const Fit bayesian = fitPsychometric(kLevels, quick(weberOptions(kReference)));
  EXPECT_NEAR(fit.w->interval.low, bayesian.w->interval.low, 0.04);
  EXPECT_NEAR(fit.w->interval.high, bayesian.w->interval.high, 0.06);
}

TEST(CompareSigmoids, PrefersTheOneTheAnswersWereMadeOf) {
  const PsychometricFunction truth{.sigmoid = Sigmoid::kGumbel, .threshold = 5, .width = 6};
  const std::vector<Level> levels = cleanAnswers(truth, {1, 2, 3, 4, 5, 6, 7, 8}, 400);
  const std::vector<Sigmoid> sigmoids{Sigmoid::kNorm, Sigmoid::kGumbel, Sigmoid::kLogistic};
  const std::vector<Fit> fits = compareSigmoids(levels, quick({.lapse = 0, .guess = 0, .overdispersion = 0}), sigmoids);
  ASSERT_EQ(fits.size(), 3u);
  EXPECT_EQ(fits[0].function.sigmoid, Sigmoid::kGumbel);
  EXPECT_LT(fits[0].aic, fits[1].aic);
  EXPECT_GE(fits[1].log_evidence, fits[2].log_evidence);
}

TEST(Fit, NonsenseIsRefused) {
  const auto fit = [](const std::vector<Level>& levels, const FitOptions& options) {
    return fitPsychometric(levels, quick(options));
  };
  EXPECT_THROW((void)fit({}, {}), InvalidParameter);
  EXPECT_THROW((void)fit({{1, 2, 4}}, {}), InvalidParameter) << "one stimulus";
  EXPECT_THROW((void)fit({{1, 0, 0}, {2, 0, 0}}, {}), InvalidParameter) << "no answers";
  EXPECT_THROW((void)fit({{-1, 2, 4}, {2, 3, 4}}, {.sigmoid = Sigmoid::kWeibull}), InvalidParameter) << "ln of -1";
  EXPECT_THROW((void)fit(kLevels, weberOptions(-1)), InvalidParameter);
  EXPECT_THROW((void)fit(kLevels, {.lapse = 0.7}), InvalidParameter);
  EXPECT_THROW((void)fit(kLevels, {.confidence = 1}), InvalidParameter);
  EXPECT_THROW((void)fit(kLevels, {.design = Design::kForcedChoice, .guess = 0.1}), InvalidParameter);
  EXPECT_THROW((void)fit(kLevels, {.design = Design::kForcedChoice, .alternatives = 1}), InvalidParameter);
  EXPECT_THROW((void)fit(kLevels, {.threshold = std::numeric_limits<double>::quiet_NaN()}), InvalidParameter);
  EXPECT_THROW((void)fitPsychometric(kLevels, {.simulations = -1}), InvalidParameter);
}

// A cumulative Gaussian of 10 % at 0.5 and 90 % at 1.5: threshold 1, known to within 1e-5.
TEST(Fit, OfABillionAnswersIsQuickAndRight) {
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<Level> levels{{0.5, 1e8, 1e9}, {1, 5e8, 1e9}, {1.5, 9e8, 1e9}};
  FitOptions options{.lapse = 0, .guess = 0, .overdispersion = 0};
  options.simulations = 200;
  const Fit fit = fitPsychometric(levels, options);
  EXPECT_NEAR(fit.threshold.value, 1, 1e-5);
  const double sigma = 0.5 / 1.2815515655446004;
  EXPECT_NEAR(fit.width.value, 3.289707253902943 * sigma, 1e-4);
  // Fisher's information of the threshold: n phi^2 / (sigma^2 Phi (1 - Phi)) of each level.
  const double density = std::exp(-0.5 * 1.2815515655446004 * 1.2815515655446004) / std::sqrt(2 * std::acos(-1));
  const double outer = density * density / 0.09;
  const double inner = 1 / (2 * std::acos(-1)) / 0.25;
  const double deviation = sigma / std::sqrt(1e9 * (2 * outer + inner));
  EXPECT_NEAR((fit.threshold.interval.high - fit.threshold.interval.low) / (2 * 1.96 * deviation), 1, 0.05);
  EXPECT_LT(fit.deviance, 0.01);
  EXPECT_GT(fit.p_value, 0.9);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(took.count(), 20);
}

TEST(Fit, IsStoppedWhileItSimulates) {
  stopAsked() = true;
  EXPECT_THROW((void)fitPsychometric(kLevels, weberOptions(kReference)), Failure);
  EXPECT_NO_THROW((void)fitPsychometric(kLevels, quick(weberOptions(kReference)))) << "a curve on a page";
  stopAsked() = false;
}

TEST(Fit, HasNoWeberFractionWhereTheThresholdMayBe0) {
  const std::vector<Level> about_zero{{-2, 1, 20}, {-1, 4, 20}, {0, 11, 20}, {1, 15, 20}, {2, 19, 20}};
  EXPECT_TRUE(std::isnan(fitPsychometric(about_zero, quick({})).weber_fraction.value));
  const Fit above = fitPsychometric(kLevels, quick({}));
  EXPECT_GT(above.weber_fraction.value, above.weber_fraction.interval.low);
  EXPECT_LT(above.weber_fraction.value, above.weber_fraction.interval.high);
}

}  // namespace
}  // namespace haptolith
