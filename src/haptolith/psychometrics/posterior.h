#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/model.h"

namespace haptolith {

/// Value with its posterior mass.
struct WeightedValue {
  double value = 0;
  double mass = 0;
};

/// Values of one parameter in a grid, with their weights in a sum.
struct GridAxis {
  Support range = {};
  bool logarithmic = false;          ///< whether the values are even, or by Gauss's rule, in their logarithm
  std::vector<double> values = {};   ///< a single one if the parameter is fixed
  std::vector<double> weights = {};  ///< one per value
};

/// Posterior of a model on a grid, summed by a Gauss-Legendre rule in each free parameter.
struct Posterior {
  std::array<GridAxis, kParameters> axes = {};
  /// Marginal mass of each value of a parameter; each marginal sums to 1.
  std::array<std::vector<double>, kParameters> marginals = {};
  /// Mass of each point; the last parameter varies fastest. Sums to 1.
  std::vector<double> mass = {};
  ParameterPoint best = {};  ///< densest point of the grid
  double log_evidence = 0;   ///< ln of the integral of likelihood times prior
};

/// Sums the posterior over the region with non-negligible density, which coarse grids over the entire support find.
[[nodiscard]] Posterior posteriorOf(const Model& model);

/// Returns the peaks of the likelihood on a coarse grid of threshold and width over the entire support: at most
/// `count`, the most likely first. Each has its most likely rates, and slight overdispersion if that is free.
[[nodiscard]] std::vector<ParameterPoint> likelihoodPeaks(const Model& model, int count);

/// Returns the interval between the percentiles (1 - confidence)/2 and (1 + confidence)/2 of one parameter's marginal;
/// if it is fixed, that value.
[[nodiscard]] Interval credibleInterval(const Posterior& posterior, int parameter, double confidence);

/// As above for any values with their masses, which need not sum to 1. Half of the mass of equal values is below them.
[[nodiscard]] Interval percentileInterval(std::vector<WeightedValue> values, double confidence);

/// Returns the point of the grid with this index into `mass`.
[[nodiscard]] ParameterPoint pointOf(const Posterior& posterior, std::size_t index);

/// Returns `count` points, at even steps of the posterior's mass.
[[nodiscard]] std::vector<ParameterPoint> drawsOf(const Posterior& posterior, int count);

}  // namespace haptolith
