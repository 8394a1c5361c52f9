#include "haptolith/core/math/portable_math.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

namespace haptolith::portable {

namespace {

// Constants in parts: a multiple of the upper ones with a small whole number is exact.
constexpr std::array<double, 3> kHalfPi{0x1.921fb54400000p+0, 0x1.0b4611a600000p-34, 0x1.3198a2e037073p-69};
constexpr std::array<double, 2> kLn2{0x1.62e42fee00000p-1, 0x1.a39ef35793c76p-33};
constexpr double kPi = std::numbers::pi;
constexpr double kPiRest = 0x1.1a62633145c07p-53;  // pi - kPi

/// c[0] + c[1] z + c[2] z^2 + ...
template <std::size_t kTerms>
double polynomial(const std::array<double, kTerms>& c, double z) {
  double sum = c[kTerms - 1];
  for (std::size_t i = kTerms - 1; i-- > 0;) {
    sum = sum * z + c[i];
  }
  return sum;
}

/// 1 / first!, 1 / (first + step)!, ..., with the sign given to every other one.
template <std::size_t kTerms>
constexpr std::array<double, kTerms> inverseFactorials(int first, int step, double sign) {
  std::array<double, kTerms> terms{};
  double factor = 1;
  for (std::size_t i = 0; i < kTerms; ++i) {
    double factorial = 1;
    for (int n = 2; n <= first + static_cast<int>(i) * step; ++n) {
      factorial *= n;
    }
    terms[i] = factor / factorial;
    factor *= sign;
  }
  return terms;
}

/// 1 / first, 1 / (first + 2), ..., with the sign given to every other one.
template <std::size_t kTerms>
constexpr std::array<double, kTerms> inverseOddNumbers(int first, double sign) {
  std::array<double, kTerms> terms{};
  double factor = 1;
  for (std::size_t i = 0; i < kTerms; ++i) {
    terms[i] = factor / (first + 2 * static_cast<int>(i));
    factor *= sign;
  }
  return terms;
}

constexpr auto kSine = inverseFactorials<8>(3, 2, -1);    // sin x = x - x^3 (1/3! - x^2 / 5! + ...)
constexpr auto kCosine = inverseFactorials<7>(4, 2, -1);  // cos x = 1 - x^2 / 2 + x^4 (1/4! - x^2 / 6! + ...)
constexpr auto kExponential = inverseFactorials<12>(2, 1, 1);
constexpr auto kArcusTangent = inverseOddNumbers<12>(3, -1);
constexpr auto kLogarithm = inverseOddNumbers<11>(3, 1);

double sineNearZero(double x) {
  const double z = x * x;
  return x - x * z * polynomial(kSine, z);
}

double cosineNearZero(double x) {
  const double z = x * x;
  const double half = 0.5 * z;
  const double most = 1 - half;
  return most + ((1 - most - half) + z * z * polynomial(kCosine, z));
}

/// An angle as quarter turns and a rest of at most an eighth of a turn.
struct Reduced {
  int quarter;  ///< 0 to 3
  double rest;
};
Reduced reduced(double x) {
  const double turns = std::floor(x * (2 / kPi) + 0.5);
  const double rest = ((x - turns * kHalfPi[0]) - turns * kHalfPi[1]) - turns * kHalfPi[2];
  return {static_cast<int>(turns - 4 * std::floor(turns / 4)), rest};
}

/// Sine of an angle that has been turned on by `quarters`.
double sineOf(const Reduced& angle, int quarters) {
  switch ((angle.quarter + quarters) % 4) {
    case 0: return sineNearZero(angle.rest);
    case 1: return cosineNearZero(angle.rest);
    case 2: return -sineNearZero(angle.rest);
    default: return -cosineNearZero(angle.rest);
  }
}

/// For 0 <= x <= 1: atan x = 2 atan(x / (1 + sqrt(1 + x^2))), twice, and a series.
double arcusTangentToOne(double x) {
  const auto halved = [](double t) { return t / (1 + std::sqrt(1 + t * t)); };
  const double t = halved(halved(x));
  const double z = t * t;
  return 4 * (t - t * z * polynomial(kArcusTangent, z));
}

}  // namespace

double sin(double x) noexcept {
  return sineOf(reduced(x), 0);
}

double cos(double x) noexcept {
  return sineOf(reduced(x), 1);
}

double tan(double x) noexcept {
  const Reduced angle = reduced(x);
  return sineOf(angle, 0) / sineOf(angle, 1);
}

double atan2(double y, double x) noexcept {
  const double up = std::abs(y);
  const double out = std::abs(x);
  if (up == 0 && out == 0) {
    return 0;
  }
  double angle = up <= out ? arcusTangentToOne(up / out) : kPi / 2 - (arcusTangentToOne(out / up) - kPiRest / 2);
  angle = x < 0 ? kPi - (angle - kPiRest) : angle;
  return y < 0 ? -angle : angle;
}

double atan(double x) noexcept {
  return atan2(x, 1);
}

double acos(double x) noexcept {
  const double held = std::clamp(x, -1.0, 1.0);
  return atan2(std::sqrt((1 - held) * (1 + held)), held);
}

double exp(double x) noexcept {
  if (!(x < 709.782712893384)) {
    return x + std::numeric_limits<double>::infinity();  // NaN stays
  }
  if (x < -745.2) {
    return 0;
  }
  const double twos = std::floor(x * std::numbers::log2e + 0.5);
  const double high = x - twos * kLn2[0];
  const double low = twos * kLn2[1];
  const double rest = high - low;
  const double beyond = (high - rest) - low;
  const double sum = rest + (beyond + rest * rest * polynomial(kExponential, rest));
  return std::ldexp(1 + sum, static_cast<int>(twos));
}

double log(double x) noexcept {
  if (!(x > 0) || x > std::numeric_limits<double>::max()) {
    return x == 0 ? -std::numeric_limits<double>::infinity() : x > 0 ? x : std::numeric_limits<double>::quiet_NaN();
  }
  int twos = 0;
  double mantissa = std::frexp(x, &twos);
  if (mantissa < std::numbers::sqrt2 / 2) {
    mantissa *= 2;
    --twos;
  }
  // log(1 + f) = f - f^2 / 2 + s (f^2 / 2 + R),  s = f / (2 + f),  R = 2 (s^2 / 3 + s^4 / 5 + ...)
  const double f = mantissa - 1;
  const double s = f / (2 + f);
  const double z = s * s;
  const double half_square = 0.5 * f * f;
  const double rest = s * (half_square + 2 * z * polynomial(kLogarithm, z));
  return twos * kLn2[0] - ((half_square - (rest + twos * kLn2[1])) - f);
}

double pow(double x, double y) noexcept {
  if (y == 0 || x == 1) {
    return 1;
  }
  return x == 0 ? (y > 0 ? 0 : std::numeric_limits<double>::infinity()) : exp(y * log(x));
}

double cbrt(double x) noexcept {
  if (x == 0 || !std::isfinite(x)) {
    return x;
  }
  const double size = std::abs(x);
  double root = exp(log(size) / 3);
  root -= (root - size / (root * root)) / 3;  // Newton's step
  return x < 0 ? -root : root;
}

}  // namespace haptolith::portable
