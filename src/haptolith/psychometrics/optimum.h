#pragma once

#include <functional>
#include <optional>
#include <span>

#include "haptolith/psychometrics/model.h"

namespace haptolith {

enum class Objective { kPosterior, kLikelihood };

/// Parameter that is not free, but follows from the others.
struct Pin {
  Parameter parameter = kThreshold;
  std::function<double(const ParameterPoint&)> value = {};
};

/// Point with the logarithm of its posterior density or likelihood.
struct Optimum {
  ParameterPoint point = {};
  double log_density = 0;  ///< minus infinity if a pinned parameter leaves its support
};

/// Options of a search.
struct Search {
  Objective objective = Objective::kLikelihood;
  std::optional<Pin> pin = std::nullopt;
  double tolerance = 1e-7;  ///< as a fraction of each parameter's support
};

/// Returns the best point of searches from each of `starts`, one or more, inside the support of the parameters. Uses
/// NLopt's Sbplx (a simplex search in subspaces; Rowan 1990), which needs no derivatives.
[[nodiscard]] Optimum optimumNear(const Model& model, std::span<const ParameterPoint> starts, const Search& search);

}  // namespace haptolith
