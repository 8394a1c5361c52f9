#pragma once

#include <span>
#include <vector>

namespace haptolith {

/// Gauss-Legendre rule between -1 and 1: the sum of f(place) times weight is the integral of f, exactly for polynomials
/// of degree 2 count - 1.
struct GaussRule {
  std::vector<double> places = {};  ///< ascending: the zeros of a Legendre polynomial
  std::vector<double> weights = {};
};

/// Returns the rule of `count` points, 2 to 10 000; cached.
[[nodiscard]] const GaussRule& gaussRule(int count);

/// Distribution function between -1 and 1 of a density given at the places of a rule: the integral of the polynomial
/// through its values, from its Legendre series.
class GaussDistribution {
 public:
  /// @param masses  density times weight at the places of gaussRule(masses.size()).
  explicit GaussDistribution(std::span<const double> masses);

  /// Returns the fraction of the mass below `place`.
  [[nodiscard]] double shareBelow(double place) const noexcept;
  /// Returns the quantile of the fraction `share`.
  [[nodiscard]] double percentile(double share) const noexcept;

 private:
  std::vector<double> coefficients_;  // coefficients of the density's Legendre polynomials, each over 2 degree + 1
};

}  // namespace haptolith
