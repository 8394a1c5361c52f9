#pragma once

#include "haptolith/psychometrics/model.h"

namespace haptolith {

enum class Objective { kPosterior, kLikelihood };

/// The point near `start` where the model's posterior density or its likelihood is largest, inside the support of its
/// parameters; found by NLopt's Sbplx (a simplex search in subspaces; Rowan 1990), which needs no derivatives.
[[nodiscard]] ParameterPoint optimumNear(const Model& model, const ParameterPoint& start, Objective objective);

}  // namespace haptolith
