#pragma once

#include <Eigen/Core>

#include <array>
#include <functional>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/model.h"

namespace haptolith {

/// Likelihood of one participant's responses over two individual numbers, such as the place of the PSE and the
/// logarithm of the Weber fraction.
struct PersonTable {
  std::vector<double> first, second;  ///< evenly spaced values of both numbers; a single one if fixed
  /// Log-likelihood of the responses at all values (rows: first, columns: second), for a value of the parameter common
  /// to all participants.
  std::function<Eigen::ArrayXXd(double shared)> log_likelihood;
};

/// Returns a log-likelihood for the values of a table.
using TableMaker = std::function<std::function<Eigen::ArrayXXd(double shared)>(const std::vector<double>& first,
                                                                               const std::vector<double>& second)>;

/// Resolution of the sums: kQuick for simulations, where the error of the sums is negligible compared with that of few
/// studies.
enum class Effort { kQuick, kThorough };

/// Returns a table of 31 values each (thorough: 61) within these supports. It is narrowed to the region with a
/// likelihood above e^-12 of its maximum for any of these values of the shared parameter.
[[nodiscard]] PersonTable closedTable(Support first, Support second, const std::vector<double>& shared, Effort effort,
                                      const TableMaker& make);

/// Parameters of a hierarchy, in the order of its grid: mean and standard deviation of the two numbers over
/// participants, and the common parameter.
enum HyperParameter { kFirstMean, kFirstSpread, kSecondMean, kSecondSpread, kShared };
inline constexpr int kHyperParameters = 5;
using HyperPoint = std::array<double, kHyperParameters>;

struct HierarchyPriors {
  std::array<Support, kHyperParameters> supports = {};
  /// Logarithms of the prior densities, which need not be normalised; empty: flat.
  std::array<std::function<double(double)>, kHyperParameters> log_densities = {};
};

struct Marginal;

/// Half-normal prior of a standard deviation between participants, >= 0; `usual` is the SD of the normal distribution.
struct SpreadPrior {
  double usual = 1;

  [[nodiscard]] Support support() const noexcept { return {0, 4 * usual}; }
  [[nodiscard]] double logDensity(double spread) const noexcept;
  /// Returns the Bayes factor (Savage-Dickey) of a spread of 0: its posterior density over its prior density.
  [[nodiscard]] double bayesFactorOfNone(const Marginal& posterior) const;
};

/// Density on a grid of ascending values.
struct Marginal {
  std::vector<double> values = {};
  /// Log density with maximum 0; minus infinity for an impossible value. A single value has all the mass.
  std::vector<double> log_density = {};
};

/// Posterior of a hierarchy.
struct HierarchyPosterior {
  std::array<Marginal, kHyperParameters> marginals = {};
  /// Mass over the two means: rows are values of kFirstMean, columns of kSecondMean. Sums to 1.
  Eigen::ArrayXXd means = {};
  std::vector<HyperPoint> draws = {};             ///< points drawn from the posterior
  std::vector<Eigen::ArrayXXd> people = {};       ///< mass of each participant at their table's values; each sums to 1
  std::vector<Eigen::ArrayXd> first_alone = {};   ///< marginal likelihood of `first` per participant
  std::vector<Eigen::ArrayXd> second_alone = {};  ///< marginal likelihood of `second` per participant
};

/// Sums the posterior of a model in which both numbers of each participant are from separate normal distributions,
///
///     p(responses | m1, s1, m2, s2, c) = product over participants of  N(m1, s1)^T L_i(c) N(m2, s2),
///
/// on grids that are narrowed to its region. L_i is a participant's table, bilinear between its values and constant
/// beyond them. N has the exact integrals of a normal distribution times the hat function about each value, so a spread
/// of 0 is not singular. Deterministic. Only the thorough sum has results for participants.
/// @throws Failure when stopAsked().
[[nodiscard]] HierarchyPosterior hierarchyOf(const std::vector<PersonTable>& people, const HierarchyPriors& priors,
                                             Effort effort);

/// Returns median and interval of a marginal. Its logarithm is cubic between the values; the density is linear next to
/// impossible ones.
[[nodiscard]] Estimate estimateOf(const Marginal& marginal, double confidence);

/// Returns the density of a marginal at a value, in 1 / its unit; 0 outside its values.
[[nodiscard]] double densityAt(const Marginal& marginal, double value);

/// Returns the density of second - first for two independent posteriors, on 201 values. Both have two values or more.
[[nodiscard]] Marginal differenceOf(const Marginal& first, const Marginal& second);

/// Returns `count` evenly spaced values from low to high.
[[nodiscard]] std::vector<double> evenly(const Support& support, int count);

}  // namespace haptolith
