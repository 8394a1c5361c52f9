#include "haptolith/psychometrics/gauss_rule.h"

#include <boost/math/special_functions/legendre.hpp>

#include <algorithm>
#include <cstddef>
#include <map>
#include <mutex>

#include "haptolith/core/assert.h"

namespace haptolith {

namespace {

GaussRule computedRule(int count) {
  const std::vector<double> zeros = boost::math::legendre_p_zeros<double>(count);  // the non-negative zeros
  GaussRule rule;
  rule.places.reserve(static_cast<std::size_t>(count));
  rule.weights.reserve(static_cast<std::size_t>(count));
  for (const double zero : zeros) {
    rule.places.push_back(zero);
    if (zero > 0) {
      rule.places.push_back(-zero);
    }
  }
  std::ranges::sort(rule.places);
  for (const double place : rule.places) {
    const double slope = boost::math::legendre_p_prime(count, place);
    rule.weights.push_back(2 / ((1 - place * place) * slope * slope));
  }
  return rule;
}

}  // namespace

const GaussRule& gaussRule(int count) {
  HAPTO_ASSERT(count >= 1);
  static std::mutex mutex;
  static std::map<int, GaussRule> rules;
  const std::lock_guard lock(mutex);
  const auto [rule, is_new] = rules.try_emplace(count);
  if (is_new) {
    rule->second = computedRule(count);
  }
  return rule->second;
}

GaussDistribution::GaussDistribution(std::span<const double> masses) : coefficients_(masses.size()) {
  HAPTO_ASSERT(!masses.empty());
  const GaussRule& rule = gaussRule(static_cast<int>(masses.size()));
  double total = 0;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    total += masses[i];
    double before = 0;
    double legendre = 1;
    for (std::size_t degree = 0; degree < masses.size(); ++degree) {
      coefficients_[degree] += masses[i] * legendre / 2;
      const double next = boost::math::legendre_next(static_cast<unsigned>(degree), rule.places[i], legendre, before);
      before = legendre;
      legendre = next;
    }
  }
  for (double& coefficient : coefficients_) {
    coefficient /= total;
  }
}

double GaussDistribution::shareBelow(double place) const noexcept {
  // The integral of (2 degree + 1) P_degree from -1 is P_(degree + 1) - P_(degree - 1).
  double before = 0;
  double legendre = 1;
  double sum = coefficients_.front();
  for (std::size_t degree = 0; degree < coefficients_.size(); ++degree) {
    const double next = boost::math::legendre_next(static_cast<unsigned>(degree), place, legendre, before);
    sum += coefficients_[degree] * (next - before);
    before = legendre;
    legendre = next;
  }
  return sum;
}

double GaussDistribution::percentile(double share) const noexcept {
  HAPTO_ASSERT(share >= 0 && share <= 1);
  constexpr int kHalvings = 40;
  double low = -1;
  double high = 1;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (shareBelow(middle) < share ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace haptolith
