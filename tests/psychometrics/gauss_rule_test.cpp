#include "haptolith/psychometrics/gauss_rule.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace haptolith {
namespace {

TEST(GaussRule, SumsPolynomialsExactly) {
  for (const int count : {2, 5, 12, 40}) {
    const GaussRule& rule = gaussRule(count);
    ASSERT_EQ(rule.places.size(), static_cast<std::size_t>(count));
    const int degree = 2 * count - 2;
    double sum = 0;
    for (int i = 0; i < count; ++i) {
      sum += rule.weights[i] * std::pow(rule.places[i], degree);
      EXPECT_TRUE(i == 0 || rule.places[i] > rule.places[i - 1]);
    }
    EXPECT_NEAR(sum, 2.0 / (degree + 1), 1e-13) << count;
  }
}

TEST(GaussDistribution, IsTheIntegralOfTheDensity) {
  const GaussRule& rule = gaussRule(24);
  const auto normal = [](double place) { return std::exp(-(place - 0.1) * (place - 0.1) / 2 / 0.04); };
  std::vector<double> masses;
  for (std::size_t i = 0; i < rule.places.size(); ++i) {
    masses.push_back(7 * rule.weights[i] * normal(rule.places[i]));
  }
  const GaussDistribution distribution(masses);
  const auto phi = [](double place) { return std::erfc((0.1 - place) / 0.2 / std::numbers::sqrt2) / 2; };
  for (const double place : {-0.4, 0.0, 0.1, 0.55}) {
    EXPECT_NEAR(distribution.shareBelow(place), phi(place), 2e-5) << place;
  }
  EXPECT_NEAR(distribution.shareBelow(-1), 0, 1e-12);
  EXPECT_NEAR(distribution.shareBelow(1), 1, 1e-12);
  EXPECT_NEAR(distribution.percentile(0.975), 0.1 + 0.2 * 1.959964, 1e-4);
  EXPECT_NEAR(distribution.percentile(0.5), 0.1, 1e-5);
}

TEST(GaussDistribution, OfADensityThatIsLargestAtItsEnd) {
  const GaussRule& rule = gaussRule(12);
  std::vector<double> masses;
  for (std::size_t i = 0; i < rule.places.size(); ++i) {
    masses.push_back(rule.weights[i] * std::exp(-4 * (1 + rule.places[i])));
  }
  const GaussDistribution distribution(masses);
  const double total = 1 - std::exp(-8);
  EXPECT_NEAR(distribution.percentile(0.025), -std::log(1 - 0.025 * total) / 4 - 1, 1e-6);
  EXPECT_NEAR(distribution.percentile(0.975), -std::log(1 - 0.975 * total) / 4 - 1, 1e-5);
}

}  // namespace
}  // namespace haptolith
