#include "haptolith/lab/tests/soil_strength.h"

#include <gtest/gtest.h>

#include <cmath>

#include "haptolith/core/error.h"

#include "small_soil.h"

namespace haptolith {
namespace {

constexpr double kRadius_m = 4e-3;

TEST(SoilStrength, OfDenseSandIsALineWithoutCohesion) {
  const MohrCoulomb peak = undisturbedStrength(coarseSand(kRadius_m), Preparation::kDense, {2000, 4000, 8000});
  EXPECT_GT(peak.friction_angle_rad, std::atan(0.4)) << "more than its contacts have";
  EXPECT_LT(peak.friction_angle_rad, 1);
  EXPECT_EQ(peak.cohesion_pa, 0) << "of grains without cohesion, whatever a line through scatter says";
}

TEST(SoilStrength, RefusesTooFewStresses) {
  EXPECT_THROW((void)undisturbedStrength(coarseSand(kRadius_m), Preparation::kDense, {1000}), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
