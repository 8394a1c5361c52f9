#include "haptolith/lab/theory/beverloo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr double kDiameter = 2e-3;
const Outlet kGlassBeads{.opening_m = 20e-3, .particle_diameter_m = kDiameter, .density_kg_m3 = 1500};

std::vector<DischargePoint> discharges(double gap) {
  std::vector<DischargePoint> points;
  for (const double opening : {12e-3, 15e-3, 20e-3, 26e-3, 34e-3, 45e-3}) {
    Outlet outlet = kGlassBeads;
    outlet.opening_m = opening;
    outlet.gap = gap;
    points.push_back({opening, beverlooRate(outlet)});
  }
  return points;
}

TEST(Beverloo, GivesTheRateOneWorksOutByHand) {
  // 20 mm - 1.4 * 2 mm = 17.2 mm; 0.58 * 1500 * sqrt(9.81) * 0.0172^2.5 = 0.1057 kg/s.
  EXPECT_NEAR(beverlooRate(kGlassBeads), 0.1057, 5e-5);
}

TEST(Beverloo, GoesWithTheRootOfGravityAndWithDensity) {
  Outlet moon = kGlassBeads;
  moon.gravity_m_s2 = 1.625;
  EXPECT_NEAR(beverlooRate(moon) / beverlooRate(kGlassBeads), std::sqrt(1.625 / 9.81), 1e-12);
  moon.density_kg_m3 *= 2;
  EXPECT_NEAR(beverlooRate(moon) / beverlooRate(kGlassBeads), 2 * std::sqrt(1.625 / 9.81), 1e-12);
  moon.gravity_m_s2 = 0;
  EXPECT_EQ(beverlooRate(moon), 0);
}

TEST(Beverloo, ScalesAsAFallWithEveryLength) {
  // Twice all lengths: a mass of 8 in sqrt(2) of the time, so a rate of 2^2.5.
  Outlet twice = kGlassBeads;
  twice.opening_m *= 2;
  twice.particle_diameter_m *= 2;
  EXPECT_NEAR(beverlooRate(twice) / beverlooRate(kGlassBeads), std::pow(2, 2.5), 1e-12);
}

TEST(DischargeFit, FindsTheLawThatMadeThePoints) {
  const DischargeFit fit = fitDischarge(discharges(kBeverlooGap), kDiameter);
  EXPECT_NEAR(fit.exponent, 2.5, 1e-12);
  EXPECT_NEAR(fit.prefactor / (0.58 * 1500 * std::sqrt(9.81)), 1, 1e-10);
  EXPECT_NEAR(fit.exponent_se, 0, 1e-12);
  EXPECT_EQ(fit.gap, 1.4);
  EXPECT_NEAR(fit.rateAt(20e-3, kDiameter), beverlooRate(kGlassBeads), 1e-12);
}

TEST(DischargeFit, OfScatteredRatesIsNearAndSaysHowNear) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.02);
  int inside = 0;
  constexpr int kTests = 400;
  for (int test = 0; test < kTests; ++test) {
    std::vector<DischargePoint> points = discharges(kBeverlooGap);
    for (DischargePoint& point : points) {
      point.rate_kg_s *= std::exp(noise(random));
    }
    const DischargeFit fit = fitDischarge(points, kDiameter);
    EXPECT_NEAR(fit.exponent, 2.5, 0.12);
    inside +=
        std::abs(fit.exponent - 2.5) < 2.776 * fit.exponent_se ? 1 : 0;  // Student's t, 4 degrees of freedom, 95 %
  }
  EXPECT_NEAR(inside, 0.95 * kTests, 15);
}

TEST(DischargeFit, WithTheWrongGapGivesTheWrongExponent) {
  // Reason for a given k: a law without a gap reads as a steeper power.
  EXPECT_GT(fitDischarge(discharges(kBeverlooGap), kDiameter, 0).exponent, 2.7);
}

TEST(DischargeFit, RefusesNonsense) {
  std::vector<DischargePoint> points = discharges(kBeverlooGap);
  EXPECT_THROW(static_cast<void>(fitDischarge(points, 0)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(fitDischarge(points, 10e-3)), InvalidParameter);  // k d is wider than the opening
  EXPECT_THROW(static_cast<void>(fitDischarge(points, kDiameter, -1)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(fitDischarge({points.data(), 2}, kDiameter)), InvalidParameter);
  points[1].rate_kg_s = 0;
  EXPECT_THROW(static_cast<void>(fitDischarge(points, kDiameter)), InvalidParameter);
  Outlet blocked = kGlassBeads;
  blocked.opening_m = 2.8e-3;
  EXPECT_THROW(static_cast<void>(beverlooRate(blocked)), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
