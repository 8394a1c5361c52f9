#pragma once

#include <span>
#include <vector>

namespace haptolith {

/// Gauss's and Legendre's rule between -1 and 1: the sum of f(place) times weight is the integral of f, exactly for
/// polynomials of degree 2 count - 1.
struct GaussRule {
  std::vector<double> places = {};  ///< ascending: the zeros of a Legendre polynomial
  std::vector<double> weights = {};
};

/// The rule of `count` points, 2 to 10 000; kept for the next who asks.
[[nodiscard]] const GaussRule& gaussRule(int count);

/// The distribution function between -1 and 1 of a density that is known at the places of a rule: the integral of the
/// polynomial through its values, from their series of Legendre polynomials.
class GaussDistribution {
 public:
  /// @param masses  density times weight at the places of gaussRule(masses.size()).
  explicit GaussDistribution(std::span<const double> masses);

  /// The share of the mass below `place`.
  [[nodiscard]] double shareBelow(double place) const noexcept;
  /// The place below which `share` of the mass lies.
  [[nodiscard]] double percentile(double share) const noexcept;

 private:
  std::vector<double> coefficients_;  // of the density's Legendre polynomials, each over 2 degree + 1
};

}  // namespace haptolith
