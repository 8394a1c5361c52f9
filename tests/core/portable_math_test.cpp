#include "haptolith/core/math/portable_math.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>

namespace haptolith {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Calls check(x) for many numbers between the two, evenly spread, and for both.
template <class Check>
void forMany(double low, double high, const Check& check) {
  std::mt19937_64 random(1);
  check(low);
  check(high);
  for (int i = 0; i < 100'000; ++i) {
    check(std::lerp(low, high, static_cast<double>(random() >> 11) * 0x1p-53));
  }
}

TEST(PortableMath, SineAndCosineAgreeWithTheLibrary) {
  for (const double largest : {1e-9, 1.0, 10.0, 1e3, 1e5}) {
    forMany(-largest, largest, [](double x) {
      ASSERT_NEAR(portable::sin(x), std::sin(x), 3e-16) << x;
      ASSERT_NEAR(portable::cos(x), std::cos(x), 3e-16) << x;
    });
  }
  EXPECT_EQ(portable::sin(0), 0);
  EXPECT_EQ(portable::cos(0), 1);
  forMany(-1.5, 1.5, [](double x) {
    ASSERT_NEAR(portable::tan(x), std::tan(x), 4 * kEpsilon * (1 + std::abs(std::tan(x)))) << x;
  });
}

TEST(PortableMath, ArcusTangentAgreesInAllQuadrants) {
  forMany(-std::numbers::pi, std::numbers::pi, [](double angle) {
    const double y = 3 * std::sin(angle), x = 3 * std::cos(angle);
    ASSERT_NEAR(portable::atan2(y, x), std::atan2(y, x), 3 * kEpsilon * std::abs(angle) + 1e-300) << angle;
  });
  EXPECT_EQ(portable::atan2(0, 0), 0);
  EXPECT_EQ(portable::atan2(0, -1), std::numbers::pi);
  EXPECT_EQ(portable::atan2(1, 0), std::numbers::pi / 2);
  EXPECT_EQ(portable::atan2(-1, 0), -std::numbers::pi / 2);
  forMany(-1, 1, [](double x) { ASSERT_NEAR(portable::acos(x), std::acos(x), 1e-15) << x; });
  EXPECT_EQ(portable::acos(1 + 1e-15), 0);
}

TEST(PortableMath, ExponentialAndLogarithmAgreeWithTheLibrary) {
  for (const double largest : {1e-9, 1.0, 700.0}) {
    forMany(-largest, largest, [](double x) { ASSERT_NEAR(portable::exp(x) / std::exp(x), 1, 2 * kEpsilon) << x; });
  }
  forMany(-300, 300, [](double power) {
    const double x = std::exp(power);
    ASSERT_NEAR(portable::log(x), std::log(x), kEpsilon * std::max(std::abs(std::log(x)), 1e-3)) << x;
    ASSERT_NEAR(portable::cbrt(-x) / static_cast<double>(std::cbrt(static_cast<long double>(-x))), 1, 2 * kEpsilon)
        << x;
  });
  forMany(0.9, 1.1,
          [](double x) { ASSERT_NEAR(portable::log(x), std::log(x), kEpsilon * std::abs(std::log(x)) + 1e-300) << x; });
  forMany(-5, 5, [](double y) {
    for (const double x : {1e-3, 0.3, 2.0, 17.0}) {
      ASSERT_NEAR(portable::pow(x, y) / std::pow(x, y), 1, kEpsilon * (2 + std::abs(y * std::log(x)))) << x << ' ' << y;
    }
  });
}

TEST(PortableMath, LimitsAreThoseOfTheLibrary) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(portable::exp(710), kInfinity);
  EXPECT_EQ(portable::exp(-746), 0);
  EXPECT_GT(portable::exp(-745), 0);
  EXPECT_EQ(portable::exp(0), 1);
  EXPECT_TRUE(std::isnan(portable::exp(std::nan(""))));
  EXPECT_EQ(portable::log(0), -kInfinity);
  EXPECT_EQ(portable::log(1), 0);
  EXPECT_EQ(portable::log(kInfinity), kInfinity);
  EXPECT_TRUE(std::isnan(portable::log(-1)));
  EXPECT_EQ(portable::cbrt(0), 0);
  EXPECT_EQ(portable::cbrt(27), 3);
  EXPECT_EQ(portable::pow(0, 2), 0);
  EXPECT_EQ(portable::pow(5, 0), 1);
}

/// Every machine and every compiler must come to these bits.
TEST(PortableMath, HasTheseBits) {
  std::uint64_t sum = 0;
  const auto add = [&](double x) { sum = std::rotl(sum, 7) ^ std::bit_cast<std::uint64_t>(x); };
  for (int i = 1; i < 20'000; ++i) {
    const double x = i * 0.001;
    for (const double value :
         {portable::sin(x), portable::cos(x), portable::tan(x), portable::exp(-x), portable::log(x),
          portable::atan2(x, 5 - x), portable::acos(x / 20), portable::cbrt(x), portable::pow(x, 1.7)}) {
      add(value);
    }
  }
  EXPECT_EQ(sum, 0xed759c8598b4726aU);
}

// Against the library of C, which is right on Linux.
TEST(PortableMath, FmaRoundsOnce) {
#ifdef _WIN32
  GTEST_SKIP() << "its C library rounds twice: compared on Linux, and the states of scenes on both";
#endif
  std::mt19937 random(1);
  const auto any = [&] {
    float number = 0;
    do {
      number = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    } while (!std::isfinite(number));
    return number;
  };
  const auto near_one = [&] { return std::ldexp(static_cast<float>(random() >> 8U), -23); };
  for (int i = 0; i < 1'000'000; ++i) {
    const bool wild = i % 2 == 0;
    const float a = wild ? any() : near_one();
    const float b = wild ? any() : near_one();
    // The last is often as small as half of the last place of the product.
    const float c = wild ? any() : std::ldexp(near_one(), -24 - static_cast<int>(random() % 4));
    const float expected = std::fma(a, b, c);
    ASSERT_EQ(std::bit_cast<std::uint32_t>(portable::fma(a, b, c)), std::bit_cast<std::uint32_t>(expected))
        << a << ' ' << b << ' ' << c;
  }
}

}  // namespace
}  // namespace haptolith
