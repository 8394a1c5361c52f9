#include "haptolith/psychometrics/likelihood.h"

#include <boost/math/special_functions/log1p.hpp>

#include <cmath>

#include "haptolith/core/assert.h"

namespace haptolith {

namespace {

/// Logarithm of a product of many factors, with few logarithm calls.
class LogProduct {
 public:
  void multiply(double factor) noexcept {
    product_ *= factor;
    if (product_ < kSmall) {  // before it underflows
      log_ += std::log(product_);
      product_ = 1;
    }
  }
  [[nodiscard]] double value() const noexcept { return log_ + std::log(product_); }

 private:
  static constexpr double kSmall = 1e-150;
  double product_ = 1;
  double log_ = 0;
};

/// Returns count ln(share), 0 if both are 0.
double logPower(double count, double share) noexcept {
  return count > 0 ? count * std::log(share) : 0;
}

double logBinomial(double k, double n, double psi) noexcept {
  HAPTO_ASSERT(k >= 0 && k <= n);
  return logPower(k, psi) + logPower(n - k, 1 - psi);
}

/// Computes the log-likelihood by gamma functions, for numbers of responses for which the product is slower.
double logBetaBinomial(double k, double n, double psi, double s) noexcept {
  HAPTO_ASSERT(k >= 0 && k <= n);
  HAPTO_ASSERT(s > 0);
  const double nu = 1 / s - 1;
  const auto rise = [](double from, double count) { return std::lgamma(from + count) - std::lgamma(from); };
  return (k > 0 ? rise(psi * nu, k) : 0) + (n - k > 0 ? rise((1 - psi) * nu, n - k) : 0) - rise(nu, n);
}

/// Returns k ln(k/m) + m - k >= 0, without cancellation for k close to m > 0 (Loader 2000).
double devianceTerm(double k, double m) noexcept {
  if (k == 0) {
    return m;
  }
  const double excess = (m - k) / k;
  return std::abs(excess) > 0.5 ? k * std::log(k / m) + m - k : -k * boost::math::log1pmx(excess);
}

constexpr double kMany = 60;

}  // namespace

double logLikelihood(double k, double n, double psi, double eta) noexcept {
  HAPTO_ASSERT(k >= 0 && k <= n);
  const double s = eta * eta;
  if (s == 0 || (n > kMany && s < kBinomial)) {
    return logBinomial(k, n, psi);
  }
  if (n > kMany && psi > 0 && psi < 1) {
    return logBetaBinomial(k, n, psi, s);
  }
  // B(k + a, n - k + b)/B(a, b) is a(a+1).. b(b+1).. / (a+b)(a+b+1)..; each factor is multiplied by s.
  LogProduct product;
  const double a = psi * (1 - s);
  const double b = (1 - psi) * (1 - s);
  double place = 0;  // index in the product of the denominator
  for (double j = 0; j < k; ++j, ++place) {
    product.multiply((a + j * s) / (1 - s + place * s));
  }
  for (double j = 0; j < n - k; ++j, ++place) {
    product.multiply((b + j * s) / (1 - s + place * s));
  }
  return product.value();
}

double logLikelihood(std::span<const Level> levels, const PsychometricFunction& function, double eta) noexcept {
  double sum = 0;
  for (const Level& level : levels) {
    sum += logLikelihood(level.k, level.n, probability(function, level.x), eta);
  }
  return sum;
}

double devianceOf(std::span<const Level> levels, const PsychometricFunction& function) noexcept {
  double sum = 0;
  for (const Level& level : levels) {
    const double expected = level.n * probability(function, level.x);
    sum += devianceTerm(level.k, expected) + devianceTerm(level.n - level.k, level.n - expected);
  }
  return 2 * sum;
}

}  // namespace haptolith
