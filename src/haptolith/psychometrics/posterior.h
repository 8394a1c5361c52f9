#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/model.h"

namespace haptolith {

/// A value with its share of the posterior.
struct WeightedValue {
  double value = 0;
  double mass = 0;
};

/// The values of one parameter in a grid, and what each of them stands for in a sum.
struct GridAxis {
  Support range = {};
  bool logarithmic = false;          ///< the values lie evenly, or by Gauss's rule, in their logarithm
  std::vector<double> values = {};   ///< one where the parameter is fixed
  std::vector<double> weights = {};  ///< the same
};

/// The posterior of a model on a grid, summed by Gauss's rule in each free parameter.
struct Posterior {
  std::array<GridAxis, kParameters> axes = {};
  /// The mass of each value of a parameter, all others summed over; each sums to 1.
  std::array<std::vector<double>, kParameters> marginals = {};
  /// The mass of each point; the last parameter runs fastest. Sums to 1.
  std::vector<double> mass = {};
  ParameterPoint best = {};  ///< the densest point of the grid
  double log_evidence = 0;   ///< ln of the integral of likelihood times prior
};

/// Sums the posterior where it is: first on coarse grids over the whole support, to find what to leave out.
[[nodiscard]] Posterior posteriorOf(const Model& model);

/// Where the likelihood has its peaks on a coarse grid of threshold and width over the whole support, each with its
/// most likely rates and a little overdispersion where that is free: at most `count`, the most likely first.
[[nodiscard]] std::vector<ParameterPoint> likelihoodPeaks(const Model& model, int count);

/// The interval between the percentiles (1 - confidence)/2 and (1 + confidence)/2 of one parameter's marginal; where it
/// is fixed, that value.
[[nodiscard]] Interval credibleInterval(const Posterior& posterior, int parameter, double confidence);

/// The same of any values with their masses, which need not sum to 1. Half of the mass of equal values lies below them.
[[nodiscard]] Interval percentileInterval(std::vector<WeightedValue> values, double confidence);

/// The point of the grid with this index into `mass`.
[[nodiscard]] ParameterPoint pointOf(const Posterior& posterior, std::size_t index);

/// `count` points, spread evenly over the posterior's mass.
[[nodiscard]] std::vector<ParameterPoint> drawsOf(const Posterior& posterior, int count);

}  // namespace haptolith
