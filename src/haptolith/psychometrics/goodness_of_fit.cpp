#include "haptolith/psychometrics/goodness_of_fit.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/random/beta_distribution.hpp>
#include <boost/random/binomial_distribution.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "haptolith/core/assert.h"
#include "haptolith/core/error.h"
#include "haptolith/core/math/random.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/psychometrics/likelihood.h"
#include "haptolith/psychometrics/optimum.h"
#include "haptolith/psychometrics/posterior.h"

namespace haptolith {

namespace {

constexpr double kTolerance = 1e-5;  // tolerance of fits to simulated studies; limited in peak widths by
constexpr double kToleranceOfPeak = 0.01;
constexpr double kFewAnswers = 100;  // up to here responses are drawn one by one, otherwise together
constexpr int kDeviancePeaks = 2;    // likelihood peaks that each fit starts from, in addition to its origin

constexpr double kDoubtful = 3;  // in standard errors

/// Returns the trend of positive responses with the stimulus, in standard errors, by Armitage's test (1955, Biometrics
/// 11, 375).
double trendOf(std::span<const Level> levels) {
  double n = 0, k = 0, places = 0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    n += levels[i].n;
    k += levels[i].k;
    places += levels[i].n * double(i);
  }
  const double fraction = k / n;
  double sum = 0, square = 0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const double place = double(i) - places / n;
    sum += place * (levels[i].k - levels[i].n * fraction);
    square += levels[i].n * place * place;
  }
  const double variance = fraction * (1 - fraction) * square;
  return variance > 0 ? sum / std::sqrt(variance) : 0;
}

double uniform(std::mt19937_64& random) {
  return (uniformSigned(random) + 1) / 2;
}

/// Draws response by response: each makes an equal one more probable (Polya's urn). @param s  eta^2.
double drawnOneByOne(double n, double psi, double s, std::mt19937_64& random) {
  HAPTO_ASSERT(psi >= 0 && psi <= 1);
  HAPTO_ASSERT(n >= 0);
  double positive = 0;
  for (double trial = 0; trial < n; ++trial) {
    const double share = (psi * (1 - s) + positive * s) / (1 - s + trial * s);
    positive += uniform(random) < share ? 1 : 0;
  }
  return positive;
}

/// As above in one draw: a binomial number with a probability from a Beta distribution.
double drawnAtOnce(double n, double psi, double s, std::mt19937_64& random) {
  HAPTO_ASSERT(psi >= 0 && psi <= 1);
  HAPTO_ASSERT(n >= 0);
  double share = psi;
  if (s >= kBinomial && psi > 0 && psi < 1) {
    const double nu = 1 / s - 1;
    share = boost::random::beta_distribution<double>(psi * nu, (1 - psi) * nu)(random);
    if (!(share >= 0 && share <= 1)) {  // nu so small that both gamma variates are 0: all responses are equal
      share = uniform(random) < psi ? 1 : 0;
    }
  }
  return static_cast<double>(boost::random::binomial_distribution<std::int64_t>(std::int64_t(n), share)(random));
}

}  // namespace

std::vector<Level> simulatedAnswers(std::span<const Level> levels, const PsychometricFunction& function,
                                    std::mt19937_64& random, double eta) {
  std::vector<Level> result(levels.begin(), levels.end());
  for (Level& level : result) {
    const double psi = probability(function, level.x);
    level.k = (level.n <= kFewAnswers ? drawnOneByOne : drawnAtOnce)(level.n, psi, eta * eta, random);
  }
  return result;
}

SimulatedFits simulatedFits(const Model& model, const ParameterPoint& point) {
  std::mt19937_64 random(model.options().seed);
  const PsychometricFunction function = model.functionAt(point);
  const double answers = std::accumulate(model.levels().begin(), model.levels().end(), 0.0,
                                         [](double sum, const Level& level) { return sum + level.n; });
  const double tolerance = std::min(kTolerance, kToleranceOfPeak / std::sqrt(answers));
  SimulatedFits fits;
  for (int i = 0; i < model.options().simulations; ++i) {
    throwIfStopped();
    const Model simulated =
        model.withAnswers(simulatedAnswers(model.levels(), function, random, point[kOverdispersion]));
    std::vector<ParameterPoint> starts = likelihoodPeaks(simulated, kDeviancePeaks);
    starts.push_back(point);
    fits.points.push_back(
        optimumNear(simulated, starts, {.objective = Objective::kLikelihood, .tolerance = tolerance}).point);
    fits.deviances.push_back(devianceOf(simulated.levels(), simulated.functionAt(fits.points.back())));
  }
  return fits;
}

double simulatedPValue(const SimulatedFits& fits, double observed) {
  if (fits.deviances.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto worse = std::ranges::count_if(fits.deviances, [&](double deviance) { return deviance >= observed; });
  return (double(worse) + 1) / (double(fits.deviances.size()) + 1);
}

std::string doubtOf(std::span<const Level> levels, const FitOptions& options) {
  const double trend = trendOf(levels);
  if (options.falling ? trend > kDoubtful : trend < -kDoubtful) {
    return fmt::format("positive responses become {} for larger stimuli: {}?", options.falling ? "more" : "fewer",
                       options.falling ? "fit a rising function, without --falling" : "fit a falling one, --falling");
  }
  double n = 0, k = 0;
  for (const Level& level : levels) {
    n += level.n;
    k += level.k;
  }
  const double guess = options.design == Design::kForcedChoice ? 1.0 / options.alternatives : 0;
  if (k - n * guess < -kDoubtful * std::sqrt(n * guess * (1 - guess))) {
    return fmt::format(
        "{:.0f} of {:.0f} responses are correct, and guessing gives 1 of {}: does 1 mean a wrong response?", k, n,
        options.alternatives);
  }
  return "";
}

double chiSquarePValue(const Model& model, double deviance) {
  const bool dispersed = !model.support(kOverdispersion).isFixed();
  const int degrees = static_cast<int>(model.levels().size()) - model.freeParameters() + (dispersed ? 1 : 0);
  if (degrees < 1) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(degrees), std::max(deviance, 0.0)));
}

}  // namespace haptolith
