#pragma once

#include <random>
#include <span>
#include <string>
#include <vector>

#include "haptolith/psychometrics/model.h"

namespace haptolith {

/// Made-up answers of somebody whose psychometric function is `function`: as many to each stimulus as in `levels`,
/// beta-binomial with the overdispersion `eta`, 0 to 1 (see logLikelihood()).
[[nodiscard]] std::vector<Level> simulatedAnswers(std::span<const Level> levels, const PsychometricFunction& function,
                                                  std::mt19937_64& random, double eta = 0);

/// Studies made up from one function, and what the most likely fits to them were.
struct SimulatedFits {
  std::vector<ParameterPoint> points = {};
  std::vector<double> deviances = {};
};

/// Makes up as many studies as the model's options ask for, from its function and overdispersion at `point`, and fits
/// each. @throws Failure when stopAsked().
[[nodiscard]] SimulatedFits simulatedFits(const Model& model, const ParameterPoint& point);

/// The share of simulated studies whose fit is no better than one with the deviance `observed`; NaN without any. The
/// observed study counts as one more.
[[nodiscard]] double simulatedPValue(const SimulatedFits& fits, double observed);

/// What answers say against the function that is fitted to them, in words; empty: nothing. Either they change with the
/// stimulus the other way than it does, or fewer are right than by guessing; overdispersion would take up both, and no
/// p value show it. Three standard errors count.
[[nodiscard]] std::string doubtOf(std::span<const Level> levels, const FitOptions& options);

/// The probability that chi-square with as many degrees of freedom as levels exceed the function's free parameters is
/// above `deviance`; NaN when none is left. An approximation for many answers to each level.
[[nodiscard]] double chiSquarePValue(const Model& model, double deviance);

}  // namespace haptolith
