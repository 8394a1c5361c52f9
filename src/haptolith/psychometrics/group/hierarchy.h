#pragma once

#include <Eigen/Core>

#include <array>
#include <functional>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/model.h"

namespace haptolith {

/// What one person's answers say of two numbers of theirs, such as the place of their PSE and the logarithm of their
/// Weber fraction.
struct PersonTable {
  std::vector<double> first, second;  ///< values of the two, evenly spaced; a single one where it is fixed
  /// The log-likelihood of the person's answers at all of them (rows: first, columns: second), for a value of the
  /// parameter that all people share.
  std::function<Eigen::ArrayXXd(double shared)> log_likelihood;
};

/// Makes a log-likelihood for the values of a table.
using TableMaker = std::function<std::function<Eigen::ArrayXXd(double shared)>(const std::vector<double>& first,
                                                                               const std::vector<double>& second)>;

/// How finely is summed: kQuick for simulations, where the error of the sums drowns in that of few studies.
enum class Effort { kQuick, kThorough };

/// A table of 31 values each (thorough: 61) that has closed in, within these supports, on where the likelihood is more
/// than e^-12 of its largest for any of these values of the shared parameter.
[[nodiscard]] PersonTable closedTable(Support first, Support second, const std::vector<double>& shared, Effort effort,
                                      const TableMaker& make);

/// The parameters of a hierarchy, in the order of its grid: mean and standard deviation of the two numbers among
/// people, and the parameter that all share.
enum HyperParameter { kFirstMean, kFirstSpread, kSecondMean, kSecondSpread, kShared };
inline constexpr int kHyperParameters = 5;
using HyperPoint = std::array<double, kHyperParameters>;

struct HierarchyPriors {
  std::array<Support, kHyperParameters> supports = {};
  /// ln of a density, which need not be normalised; none: flat.
  std::array<std::function<double(double)>, kHyperParameters> log_densities = {};
};

struct Marginal;

/// A standard deviation between people, >= 0, with a half-normal prior: `usual` is the normal distribution's own.
struct SpreadPrior {
  double usual = 1;

  [[nodiscard]] Support support() const noexcept { return {0, 4 * usual}; }
  [[nodiscard]] double logDensity(double spread) const noexcept;
  /// The Bayes factor (Savage and Dickey) of a spread of 0: its density in the posterior over that in the prior.
  [[nodiscard]] double bayesFactorOfNone(const Marginal& posterior) const;
};

/// A density on a grid of ascending values.
struct Marginal {
  std::vector<double> values = {};
  /// Its largest is 0; minus infinity where a value is impossible. A single value has all the mass.
  std::vector<double> log_density = {};
};

/// The posterior of a hierarchy.
struct HierarchyPosterior {
  std::array<Marginal, kHyperParameters> marginals = {};
  /// Mass over the two means: rows are the values of kFirstMean, columns of kSecondMean. Sums to 1.
  Eigen::ArrayXXd means = {};
  std::vector<HyperPoint> draws = {};             ///< points as probable as the posterior has them
  std::vector<Eigen::ArrayXXd> people = {};       ///< each one's mass at their table's values; each sums to 1
  std::vector<Eigen::ArrayXd> first_alone = {};   ///< each one's likelihood of `first`, the rest summed over
  std::vector<Eigen::ArrayXd> second_alone = {};  ///< the same of `second`
};

/// Sums the posterior of a model in which both numbers of each person come from normal distributions of their own,
///
///     p(answers | m1, s1, m2, s2, c) = product over people of  N(m1, s1)^T L_i(c) N(m2, s2),
///
/// on grids that close in on where it is. L_i is a person's table, bilinear between its values and constant beyond
/// them; N holds the exact integrals of a normal distribution times the hat function about each value, so that a spread
/// of 0 is a place like any other. Deterministic. Only the thorough sum says what the people are, too.
/// @throws Failure when stopAsked().
[[nodiscard]] HierarchyPosterior hierarchyOf(const std::vector<PersonTable>& people, const HierarchyPriors& priors,
                                             Effort effort);

/// Median and interval of a marginal; its logarithm is taken as a cubic between the values, and the density as straight
/// next to impossible ones.
[[nodiscard]] Estimate estimateOf(const Marginal& marginal, double confidence);

/// The density of a marginal at a value, in 1 / its unit; 0 outside its values.
[[nodiscard]] double densityAt(const Marginal& marginal, double value);

/// The density of second - first, of which each is known by itself: of two independent posteriors, on 201 values. Both
/// have two values or more.
[[nodiscard]] Marginal differenceOf(const Marginal& first, const Marginal& second);

/// `count` values from low to high.
[[nodiscard]] std::vector<double> evenly(const Support& support, int count);

}  // namespace haptolith
