#pragma once

#include <random>

#include "haptolith/psychometrics/model.h"

namespace haptolith {

/// Made-up answers of somebody whose psychometric function is `function`: as many to each stimulus as in `levels`.
[[nodiscard]] std::vector<Level> simulatedAnswers(std::span<const Level> levels, const PsychometricFunction& function,
                                                  std::mt19937_64& random);

/// How often answers made up from `function` fit their own most likely function worse than the model's answers fit
/// theirs (deviance `observed`), of `simulations`; NaN when that is 0.
[[nodiscard]] double simulatedPValue(const Model& model, const ParameterPoint& point, double observed);

/// The probability that chi-square with as many degrees of freedom as levels exceed the function's free parameters is
/// above `deviance`; NaN when none is left. An approximation for many answers to each level.
[[nodiscard]] double chiSquarePValue(const Model& model, double deviance);

}  // namespace haptolith
