#include "haptolith/lab/theory/bearing_capacity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

using Theory = BearingCapacity (*)(const Footing&);
constexpr Theory kTheories[] = {terzaghiBearing, terzaghiLocalBearing, meyerhofBearing, vesicBearing};

const Footing kSand{.diameter_m = 0.06, .density_kg_m3 = 1500, .friction_angle_rad = 35 * kDegree};

/// Factors as published: Bowles, Foundation Analysis and Design (5th ed., 1996), tables 4-2 and 4-4.
struct Row {
  double deg, n_c, n_q, n_gamma;
};

void expectFactors(Theory theory, const std::vector<Row>& rows, double share) {
  for (const Row& row : rows) {
    Footing footing = kSand;
    footing.friction_angle_rad = row.deg * kDegree;
    const BearingCapacity found = theory(footing);
    EXPECT_NEAR(found.n_c, row.n_c, share * row.n_c) << row.deg;
    EXPECT_NEAR(found.n_q, row.n_q, share * row.n_q + 0.05) << row.deg;
    EXPECT_NEAR(found.n_gamma, row.n_gamma, share * row.n_gamma + 0.06) << row.deg;
  }
}

TEST(BearingCapacity, HasTerzaghisPublishedFactors) {
  expectFactors(terzaghiBearing,
                {{0, 5.7, 1, 0},
                 {10, 9.6, 2.7, 1.2},
                 {20, 17.7, 7.4, 5},
                 {30, 37.2, 22.5, 19.7},
                 {35, 57.8, 41.4, 42.4},
                 {40, 95.7, 81.3, 100.4},
                 {45, 172.3, 173.3, 297.5},
                 {50, 347.5, 415.1, 1153.2}},
                0.012);
}

/// Das, Principles of Foundation Engineering: N'_c, N'_q of local shear at 30 deg.
TEST(BearingCapacity, OfLooseSoilHasTheFactorsOfTwoThirdsOfItsFriction) {
  Footing sand = kSand;
  sand.friction_angle_rad = 30 * kDegree;
  const BearingCapacity loose = terzaghiLocalBearing(sand);
  EXPECT_NEAR(loose.n_c, 18.99, 0.02);
  EXPECT_NEAR(loose.n_q, 8.31, 0.01);
  sand.friction_angle_rad = 0;
  sand.cohesion_pa = 900;
  EXPECT_NEAR(terzaghiLocalBearing(sand).pressure_pa, terzaghiBearing(sand).pressure_pa * 2 / 3, 1e-9);
}

TEST(BearingCapacity, HasMeyerhofsPublishedFactors) {
  expectFactors(
      meyerhofBearing,
      {{0, 5.14, 1, 0}, {10, 8.34, 2.5, 0.4}, {20, 14.83, 6.4, 2.9}, {30, 30.13, 18.4, 15.7}, {40, 75.25, 64.1, 93.6}},
      0.004);
}

TEST(BearingCapacity, HasVesicsPublishedFactors) {
  expectFactors(
      vesicBearing,
      {{0, 5.14, 1, 0}, {10, 8.34, 2.5, 1.2}, {20, 14.83, 6.4, 5.4}, {30, 30.13, 18.4, 22.4}, {40, 75.25, 64.1, 109.4}},
      0.004);
}

TEST(BearingCapacity, OfCohesionlessSoilOnItsSurfaceGrowsWithDensityGravityAndSizeExactly) {
  for (const Theory theory : kTheories) {
    const double one = theory(kSand).pressure_pa;
    ASSERT_GT(one, 0);
    Footing other = kSand;
    other.density_kg_m3 *= 2;
    other.gravity_m_s2 /= 6;
    other.diameter_m *= 5;
    EXPECT_NEAR(theory(other).pressure_pa, 2.0 / 6 * 5 * one, 1e-12 * one);
  }
}

TEST(BearingCapacity, WithoutFrictionIsPrandtlsTimesTheShapeAndDepthOfACircle) {
  Footing clay{.diameter_m = 1, .density_kg_m3 = 1800, .cohesion_pa = 1000};
  EXPECT_NEAR(terzaghiBearing(clay).pressure_pa, 1.3 * 5.712 * 1000, 1);
  EXPECT_NEAR(meyerhofBearing(clay).pressure_pa, 1.2 * 5.142 * 1000, 1);
  EXPECT_NEAR(vesicBearing(clay).pressure_pa, (5.142 + 1) * 1000, 1);
}

TEST(BearingCapacity, NeverFallsWithAngleDepthOrCohesion) {
  for (const Theory theory : kTheories) {
    for (int deg = 0; deg < 50; ++deg) {
      Footing footing = kSand;
      footing.friction_angle_rad = deg * kDegree;
      const double here = theory(footing).pressure_pa;
      for (const auto member : {&Footing::friction_angle_rad, &Footing::depth_m, &Footing::cohesion_pa}) {
        Footing more = footing;
        more.*member += member == &Footing::friction_angle_rad ? kDegree : 0.01;
        EXPECT_GE(theory(more).pressure_pa, here) << deg;
      }
    }
  }
}

TEST(BearingCapacity, RefusesNonsense) {
  for (const Theory theory : kTheories) {
    const auto refused = [&](double Footing::*member, double value) {
      Footing footing = kSand;
      footing.*member = value;
      EXPECT_THROW((void)theory(footing), InvalidParameter) << value;
    };
    refused(&Footing::diameter_m, 0);
    refused(&Footing::depth_m, -0.001);
    refused(&Footing::depth_m, 0.16);
    refused(&Footing::density_kg_m3, 0);
    refused(&Footing::gravity_m_s2, 0);
    refused(&Footing::friction_angle_rad, 51 * kDegree);
    refused(&Footing::cohesion_pa, -1);
    refused(&Footing::cohesion_pa, std::numeric_limits<double>::quiet_NaN());
  }
}

/// Critical rigidity indices of square footings as published: Vesic 1973, table.
TEST(BearingCapacity, HasVesicsPublishedCriticalRigidity) {
  struct Critical {
    double deg, index;
  };
  for (const auto& [deg, index] : {Critical{10, 15}, Critical{20, 30}, Critical{30, 70}, Critical{40, 225},
                                   Critical{45, 482}, Critical{50, 1258}}) {
    Footing footing = kSand;
    footing.friction_angle_rad = deg * kDegree;
    EXPECT_NEAR(vesicCompressibleBearing(footing, {.shear_modulus_pa = 1e6}).critical_rigidity_index, index,
                0.03 * index)
        << deg;
  }
}

TEST(BearingCapacity, OfRigidSoilIsThatOfGeneralFailureAndFallsContinuouslyWithItsModulus) {
  Footing soil = kSand;
  soil.depth_m = 0.006;
  soil.cohesion_pa = 500;
  const double rigid_pa = vesicBearing(soil).pressure_pa;
  EXPECT_EQ(vesicCompressibleBearing(soil, {.shear_modulus_pa = 1e9}).pressure_pa, rigid_pa);
  double before_pa = rigid_pa;
  for (double modulus_pa = 1e7; modulus_pa > 1e3; modulus_pa /= 1.05) {
    const CompressibleBearing found = vesicCompressibleBearing(soil, {.shear_modulus_pa = modulus_pa});
    EXPECT_LE(found.pressure_pa, before_pa);
    EXPECT_GT(found.pressure_pa, 0.9 * before_pa) << "continuous where soil becomes rigid, too";
    before_pa = found.pressure_pa;
  }
  EXPECT_LT(before_pa, 0.2 * rigid_pa);
}

/// By hand, with phi = 40 deg, c = 0, D = 0.1 m on the surface of 1600 kg/m^3 on Earth: q' = 785 Pa,
/// I_r = 20 000 / 659 = 30.4, with 2 % I_rr = 18.9, zeta = exp(-3.189 + 3.07 * 0.3913 * 1.577) = 0.274,
/// N_gamma = 109.4.
TEST(BearingCapacity, OfCompressibleSoilAgreesWithACalculationByHand) {
  const Footing sand{
      .diameter_m = 0.1, .density_kg_m3 = 1600, .gravity_m_s2 = 9.81, .friction_angle_rad = 40 * kDegree};
  const CompressibleBearing found = vesicCompressibleBearing(sand, {.shear_modulus_pa = 20'000, .volume_strain = 0.02});
  EXPECT_NEAR(found.rigidity_index, 18.9, 0.1);
  EXPECT_NEAR(found.compressibility_factor, 0.274, 0.003);
  EXPECT_NEAR(found.pressure_pa, 0.274 * 0.3 * 1600 * 9.81 * 0.1 * 109.4, 150);
}

TEST(BearingCapacity, OfCompressibleSoilRefusesNonsense) {
  for (const Compressibility& soil : {Compressibility{.shear_modulus_pa = 0}, Compressibility{.shear_modulus_pa = -1},
                                      Compressibility{.shear_modulus_pa = 1e5, .volume_strain = -0.1},
                                      Compressibility{.shear_modulus_pa = 1e5, .volume_strain = 1.1},
                                      Compressibility{.shear_modulus_pa = std::numeric_limits<double>::quiet_NaN()}}) {
    EXPECT_THROW((void)vesicCompressibleBearing(kSand, soil), InvalidParameter);
  }
}

}  // namespace
}  // namespace haptolith
