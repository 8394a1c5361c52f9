#pragma once

#include <random>
#include <span>
#include <string>
#include <vector>

#include "haptolith/psychometrics/model.h"

namespace haptolith {

/// Simulates responses of a participant with the psychometric function `function`: as many to each stimulus as in
/// `levels`, beta-binomial with the overdispersion `eta`, 0 to 1 (see logLikelihood()).
[[nodiscard]] std::vector<Level> simulatedAnswers(std::span<const Level> levels, const PsychometricFunction& function,
                                                  std::mt19937_64& random, double eta = 0);

/// Maximum-likelihood fits to studies simulated from one function.
struct SimulatedFits {
  std::vector<ParameterPoint> points = {};
  std::vector<double> deviances = {};
};

/// Simulates the studies of the model's options from its function and overdispersion at `point`, and fits each.
/// @throws Failure when stopAsked().
[[nodiscard]] SimulatedFits simulatedFits(const Model& model, const ParameterPoint& point);

/// Returns the fraction of simulated studies with a deviance of at least `observed`; NaN without any. The observed
/// study counts as one more.
[[nodiscard]] double simulatedPValue(const SimulatedFits& fits, double observed);

/// Describes a contradiction between responses and the fitted function; empty: none. Responses may change with the
/// stimulus in the opposite direction, or fewer may be correct than by guessing. Overdispersion would absorb both, so
/// no p value would show it. The limit is three standard errors.
[[nodiscard]] std::string doubtOf(std::span<const Level> levels, const FitOptions& options);

/// Returns the probability that chi-square exceeds `deviance`, with degrees of freedom levels minus free parameters of
/// the function; NaN without any. An approximation for many responses per level.
[[nodiscard]] double chiSquarePValue(const Model& model, double deviance);

}  // namespace haptolith
