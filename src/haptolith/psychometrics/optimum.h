#pragma once

#include <functional>
#include <optional>
#include <span>

#include "haptolith/psychometrics/model.h"

namespace haptolith {

enum class Objective { kPosterior, kLikelihood };

/// A parameter that is no longer free, but follows from the others.
struct Pin {
  Parameter parameter = kThreshold;
  std::function<double(const ParameterPoint&)> value = {};
};

/// A point with the logarithm of what was looked for, the posterior's density or the likelihood.
struct Optimum {
  ParameterPoint point = {};
  double log_density = 0;  ///< minus infinity where a pinned parameter leaves its support
};

/// How a search is done.
struct Search {
  Objective objective = Objective::kLikelihood;
  std::optional<Pin> pin = std::nullopt;
  double tolerance = 1e-7;  ///< as a share of each parameter's support
};

/// The best of the points that are found from each of `starts`, one or more, inside the support of the parameters; by
/// NLopt's Sbplx (a simplex search in subspaces; Rowan 1990), which needs no derivatives.
[[nodiscard]] Optimum optimumNear(const Model& model, std::span<const ParameterPoint> starts, const Search& search);

}  // namespace haptolith
