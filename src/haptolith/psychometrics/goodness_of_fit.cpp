#include "haptolith/psychometrics/goodness_of_fit.h"

#include <boost/math/distributions/chi_squared.hpp>

#include <limits>

#include "haptolith/core/random.h"
#include "haptolith/psychometrics/likelihood.h"
#include "haptolith/psychometrics/optimum.h"

namespace haptolith {

std::vector<Level> simulatedAnswers(std::span<const Level> levels, const PsychometricFunction& function,
                                    std::mt19937_64& random) {
  std::vector<Level> result(levels.begin(), levels.end());
  for (Level& level : result) {
    const double psi = probability(function, level.x);
    double positive = 0;
    for (double trial = 0; trial < level.n; ++trial) {
      positive += (evenly(random) + 1) / 2 < psi ? 1 : 0;
    }
    level.k = positive;
  }
  return result;
}

double simulatedPValue(const Model& model, const ParameterPoint& point, double observed) {
  const int simulations = model.options().simulations;
  if (simulations == 0) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  std::mt19937_64 random(model.options().seed);
  const PsychometricFunction function = model.functionAt(point);
  ParameterPoint start = point;
  int worse = 0;
  for (int i = 0; i < simulations; ++i) {
    const Model simulated = model.withAnswers(simulatedAnswers(model.levels(), function, random));
    const ParameterPoint best = optimumNear(simulated, start, Objective::kLikelihood);
    const double deviance = devianceOf(simulated.levels(), simulated.functionAt(best));
    worse += deviance >= observed ? 1 : 0;
  }
  return (worse + 1.0) / (simulations + 1.0);
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
