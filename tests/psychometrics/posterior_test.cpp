#include "haptolith/psychometrics/posterior.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/likelihood.h"
#include "haptolith/psychometrics/model.h"

namespace haptolith {
namespace {

constexpr double kReference = 0.835;

/// A thousand responses per level of the paper's friction study, from a participant with w = 0.29 and no bias.
std::vector<Level> thousandAnswers() {
  std::vector<Level> levels;
  for (const double x : {0.6, 0.648, 0.735, 1.0, 1.21}) {
    levels.push_back({x, std::round(1000 * probability(weberFunction(kReference, 0.29), x)), 1000});
  }
  return levels;
}

FitOptions freeThreshold() {
  FitOptions options = weberOptions(kReference);
  options.threshold.reset();
  options.simulations = 0;
  return options;
}

/// The likelihood of w with the threshold summed over, at most 1, by a sum as dense as it takes.
std::vector<double> summedDensely(const Model& model, const std::vector<double>& ws) {
  std::vector<double> result;
  for (const double w : ws) {
    double sum = 0;
    for (double place = std::log(0.75); place < std::log(0.93); place += 2e-4) {
      sum += std::exp(model.logLikelihood({place, w, 0, 0, 0}) + 2400);
    }
    result.push_back(sum);
  }
  const double most = std::ranges::max(result);
  for (double& value : result) {
    value /= most;
  }
  return result;
}

TEST(Posterior, OfAThousandAnswersALevelIsThatOfADenseSum) {
  const Model model(thousandAnswers(), freeThreshold());
  std::vector<double> ws;
  for (double w = 0.24; w < 0.35; w += 2.5e-4) {
    ws.push_back(w);
  }
  const std::vector<double> likelihood = summedDensely(model, ws);
  std::vector<WeightedValue> dense;
  for (std::size_t i = 0; i < ws.size(); ++i) {
    dense.push_back({ws[i], likelihood[i] / (ws[i] * ws[i])});
  }
  const Interval expected = percentileInterval(dense, 0.95);
  const Interval found = credibleInterval(posteriorOf(model), kScale, 0.95);
  EXPECT_NEAR(found.low, expected.low, 0.01 * (expected.high - expected.low));
  EXPECT_NEAR(found.high, expected.high, 0.01 * (expected.high - expected.low));
}

TEST(PercentileInterval, TakesEqualValuesTogether) {
  const std::vector<WeightedValue> each{{1, 0.5}, {2, 0.5}};
  const std::vector<WeightedValue> in_parts{{2, 0.1}, {1, 0.25}, {2, 0.4}, {1 + 1e-15, 0.25}};
  for (const std::vector<WeightedValue>& values : {each, in_parts}) {
    const Interval interval = percentileInterval(values, 0.2);
    EXPECT_NEAR(interval.low, 1.3, 1e-9);
    EXPECT_NEAR(interval.high, 1.7, 1e-9);
  }
}

TEST(Fit, WAndTheWeberFractionHaveOneInterval) {
  const std::vector<Level> levels{{0.6, 4, 24}, {0.648, 6, 24}, {0.735, 8, 24}, {1, 17, 24}, {1.21, 20, 24}};
  FitOptions options = freeThreshold();
  options.lapse.reset();
  const Fit fit = fitPsychometric(levels, options);
  EXPECT_NEAR(fit.weber_fraction.interval.low, fit.w->interval.low, 1e-9);
  EXPECT_NEAR(fit.weber_fraction.interval.high, fit.w->interval.high, 1e-9);
  EXPECT_LT(fit.jnd.interval.low / fit.threshold.value, fit.w->interval.low * 1.1);
}

TEST(Fit, TheJndOfALinearAxisFollowsTheWidth) {
  const std::vector<Level> levels{{0.6, 4, 24}, {0.648, 6, 24}, {0.735, 8, 24}, {1, 17, 24}, {1.21, 20, 24}};
  const Fit fit = fitPsychometric(levels, {.lapse = 0, .guess = 0, .overdispersion = 0, .simulations = 0});
  EXPECT_NEAR(fit.jnd.interval.low / fit.width.interval.low, fit.jnd.value / fit.width.value, 1e-9);
  EXPECT_NEAR(fit.jnd.interval.high / fit.width.interval.high, fit.jnd.value / fit.width.value, 1e-9);
}

}  // namespace
}  // namespace haptolith
