#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

/// Functions with the same bits on every processor and C library: they use only sums, products, quotients and square
/// roots, which IEEE 754 rounds correctly, and the build allows no contraction. C libraries differ in the last bit. The
/// bed, its tools and the loop use these instead of those of <cmath>; tests/core/portable_math_test.cpp has their
/// errors. All may be called in the tick.
namespace haptolith::portable {

/// Sine and cosine of an angle in rad, |x| <= 1e5, with an absolute error below 3e-16.
[[nodiscard]] double sin(double x) noexcept;
[[nodiscard]] double cos(double x) noexcept;
/// Tangent: sin(x) / cos(x).
[[nodiscard]] double tan(double x) noexcept;

/// Arcus tangent of y / x in rad, -pi to pi; 0 for two zeros.
[[nodiscard]] double atan2(double y, double x) noexcept;
[[nodiscard]] double atan(double x) noexcept;
/// Arcus cosine in rad; arguments outside -1 to 1 count as the nearer of these.
[[nodiscard]] double acos(double x) noexcept;

/// e^x. Infinite above 709.78, and 0 below -745.
[[nodiscard]] double exp(double x) noexcept;
/// Natural logarithm; -infinity at 0, NaN below.
[[nodiscard]] double log(double x) noexcept;
/// x^y for x >= 0; relative error of 2e-16 (1 + |y ln x|).
[[nodiscard]] double pow(double x, double y) noexcept;
[[nodiscard]] double cbrt(double x) noexcept;

/// Length of (x, y) and of (x, y, z): squares must not overflow.
[[nodiscard]] inline double hypot(double x, double y) noexcept {
  return std::sqrt(x * x + y * y);
}
[[nodiscard]] inline double hypot(double x, double y, double z) noexcept {
  return std::sqrt(x * x + y * y + z * z);
}

/// a b + c with one rounding, which some libraries of C get wrong: MinGW's rounds twice.
[[nodiscard]] inline float fma(float a, float b, float c) noexcept {
  const double product = static_cast<double>(a) * b;  // exact
  double sum = product + c;
  const double added = sum - product;
  const double lost = (product - (sum - added)) + (c - added);
  if (lost != 0 && std::isfinite(sum)) {
    // Rounded to odd, so that the second rounding has the effect of one alone.
    auto bits = std::bit_cast<std::uint64_t>(sum);
    if ((bits & 1U) == 0) {
      bits = (lost > 0) == (sum > 0) ? bits + 1 : bits - 1;
    }
    sum = std::bit_cast<double>(bits);
  }
  return static_cast<float>(sum);
}

[[nodiscard]] constexpr double square(double x) noexcept {
  return x * x;
}
[[nodiscard]] constexpr double cube(double x) noexcept {
  return x * x * x;
}

}  // namespace haptolith::portable
