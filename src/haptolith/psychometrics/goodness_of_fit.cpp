#include "haptolith/psychometrics/goodness_of_fit.h"

#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <limits>

#include "haptolith/core/random.h"
#include "haptolith/psychometrics/likelihood.h"
#include "haptolith/psychometrics/optimum.h"
#include "haptolith/psychometrics/posterior.h"

namespace haptolith {

namespace {

constexpr double kTolerance = 1e-5;  // of the fits to simulated studies
constexpr int kDeviancePeaks = 2;    // of the likelihood, from which each simulated study is fitted besides its origin

}  // namespace

std::vector<Level> simulatedAnswers(std::span<const Level> levels, const PsychometricFunction& function,
                                    std::mt19937_64& random, double eta) {
  std::vector<Level> result(levels.begin(), levels.end());
  for (Level& level : result) {
    const double psi = probability(function, level.x);
    // Answer by answer: each makes the next one like it more probable (Polya's urn).
    const double s = eta * eta;
    double positive = 0;
    for (double trial = 0; trial < level.n; ++trial) {
      const double share = (psi * (1 - s) + positive * s) / (1 - s + trial * s);
      positive += (uniformSigned(random) + 1) / 2 < share ? 1 : 0;
    }
    level.k = positive;
  }
  return result;
}

SimulatedFits simulatedFits(const Model& model, const ParameterPoint& point) {
  std::mt19937_64 random(model.options().seed);
  const PsychometricFunction function = model.functionAt(point);
  SimulatedFits fits;
  for (int i = 0; i < model.options().simulations; ++i) {
    const Model simulated =
        model.withAnswers(simulatedAnswers(model.levels(), function, random, point[kOverdispersion]));
    std::vector<ParameterPoint> starts = likelihoodPeaks(simulated, kDeviancePeaks);
    starts.push_back(point);
    fits.points.push_back(
        optimumNear(simulated, starts, {.objective = Objective::kLikelihood, .tolerance = kTolerance}).point);
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

double chiSquarePValue(const Model& model, double deviance) {
  const bool dispersed = !model.support(kOverdispersion).isFixed();
  const int degrees = static_cast<int>(model.levels().size()) - model.freeParameters() + (dispersed ? 1 : 0);
  if (degrees < 1) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(degrees), std::max(deviance, 0.0)));
}

}  // namespace haptolith
