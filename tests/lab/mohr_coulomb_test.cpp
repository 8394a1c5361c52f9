#include "haptolith/lab/theory/mohr_coulomb.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
const std::vector<double> kNormalStresses{1000, 2000, 4000, 6000, 8000};

std::vector<ShearPoint> specimens(double friction_angle_rad, double cohesion_pa) {
  std::vector<ShearPoint> points;
  for (const double normal : kNormalStresses) {
    points.push_back({normal, cohesion_pa + normal * std::tan(friction_angle_rad)});
  }
  return points;
}

TEST(MohrCoulomb, FindsTheStrengthOfSpecimensWithoutScatter) {
  const MohrCoulomb strength = fitMohrCoulomb(specimens(37 * kDegree, 450));
  EXPECT_NEAR(strength.friction_angle_rad, 37 * kDegree, 1e-12);
  EXPECT_NEAR(strength.cohesion_pa, 450, 1e-8);
  EXPECT_NEAR(strength.friction_angle_se_rad, 0, 1e-12);
  EXPECT_NEAR(strength.cohesion_se_pa, 0, 1e-8);
}

TEST(MohrCoulomb, StandardErrorsAreTheScatterOfRepeatedTests) {
  constexpr int kTests = 4000;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 100);
  double angle_squares = 0;
  double cohesion_squares = 0;
  double angle_variance = 0;
  double cohesion_variance = 0;
  for (int test = 0; test < kTests; ++test) {
    std::vector<ShearPoint> points = specimens(35 * kDegree, 1000);
    for (ShearPoint& point : points) {
      point.shear_stress_pa += noise(random);
    }
    const MohrCoulomb strength = fitMohrCoulomb(points);
    angle_squares += std::pow(strength.friction_angle_rad - 35 * kDegree, 2);
    cohesion_squares += std::pow(strength.cohesion_pa - 1000, 2);
    angle_variance += std::pow(strength.friction_angle_se_rad, 2);
    cohesion_variance += std::pow(strength.cohesion_se_pa, 2);
  }
  // Variances of 4000 tests with three degrees of freedom each scatter by 2 to 3 %.
  EXPECT_NEAR(angle_variance / angle_squares, 1, 0.1);
  EXPECT_NEAR(cohesion_variance / cohesion_squares, 1, 0.1);
}

TEST(MohrCoulomb, CountsEverySpecimenTheSame) {
  // 100 Pa more for the weakest specimen turn the line as much as 100 Pa less for the strongest.
  const std::vector<ShearPoint> weak{{1000, 1100}, {2000, 2000}, {3000, 3000}};
  const std::vector<ShearPoint> strong{{1000, 1000}, {2000, 2000}, {3000, 2900}};
  EXPECT_NEAR(fitMohrCoulomb(weak).friction_angle_rad, fitMohrCoulomb(strong).friction_angle_rad, 1e-12);
}

TEST(MohrCoulomb, TellsANegativeCohesionAsItIs) {
  const std::vector<ShearPoint> points{{1000, 500}, {2000, 1300}, {3000, 2100}};
  EXPECT_NEAR(fitMohrCoulomb(points).cohesion_pa, -300, 1e-9);
}

TEST(MohrCoulomb, RefusesNonsense) {
  const std::vector<ShearPoint> two{{1000, 500}, {2000, 1300}};
  const std::vector<ShearPoint> one_load{{1000, 500}, {1000, 510}, {1000, 490}};
  const std::vector<ShearPoint> pulled{{-1000, 500}, {1000, 1300}, {2000, 1400}};
  const std::vector<ShearPoint> broken{{1000, 500}, {2000, std::nan("")}, {3000, 1400}};
  for (const auto& points : {two, one_load, pulled, broken}) {
    EXPECT_THROW(static_cast<void>(fitMohrCoulomb(points)), InvalidParameter);
  }
}

}  // namespace
}  // namespace haptolith
