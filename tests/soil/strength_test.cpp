#include "haptolith/soil/strength.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

TEST(Friction, IsSqrtSixTimesTheModelFriction) {
  EXPECT_NEAR(frictionCoefficient(0.494), 1.21005, 1e-5);
  EXPECT_NEAR(frictionCoefficient(0.245), 0.60012, 1e-5);
  EXPECT_DOUBLE_EQ(modelFriction(frictionCoefficient(0.3)), 0.3);
}

TEST(Friction, AngleIsItsArcTangent) {
  EXPECT_NEAR(frictionAngle(1), std::numbers::pi / 4, 1e-15);
  EXPECT_NEAR(frictionAngle(0.6) * 180 / std::numbers::pi, 30.96, 0.01);
}

TEST(Friction, OfThePresetsIsThatOfLunarSoil) {
  for (const Preset& preset : presets()) {
    const double angle = frictionAngle(frictionCoefficient(preset.soil.mu_hat)) * 180 / std::numbers::pi;
    EXPECT_GE(angle, 30) << preset.name;
    EXPECT_LE(angle, 51) << preset.name;
  }
}

TEST(Friction, RefusesNonsense) {
  EXPECT_THROW(static_cast<void>(frictionCoefficient(-0.1)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(modelFriction(std::nan(""))), InvalidParameter);
  EXPECT_THROW(static_cast<void>(frictionAngle(-1)), InvalidParameter);
}

TEST(CompactedDistance, KeepsTheMass) {
  // Even compaction shrinks every length by the cube root of the density ratio.
  const SoilParameters soil = findPreset("P3").soil;
  const double shrink = compactedDistance(soil) / (2 * soil.radius_m);
  EXPECT_NEAR(soil.rho0_kg_m3 / std::pow(shrink, 3), 1967, 1e-9);
}

TEST(Cohesion, IsTheEquation) {
  for (const Preset& preset : presets()) {
    const SoilParameters& soil = preset.soil;
    const double r = soil.radius_m;
    const double ratio = soil.rho0_kg_m3 / soil.rho_max_kg_m3;
    const double a_min = r * std::sqrt(8.0 / 3 * ratio * ratio + 4.0 / 3);
    const double a_1 = 2 * r * std::pow(soil.rho0_kg_m3 / 1967, 1.0 / 3);
    const double expected =
        6 * std::sqrt(3.0) * soil.mu_hat * soil.gamma_nm / (a_1 * a_1) * (1 / (a_1 - a_min) - 1 / (2 * r - a_min));
    EXPECT_NEAR(cohesion(soil), expected, 1e-9) << preset.name;
  }
}

TEST(Cohesion, IsTheSameForAllPresets) {
  for (const Preset& preset : presets()) {
    EXPECT_GE(cohesion(preset.soil), 991.5) << preset.name;
    EXPECT_LE(cohesion(preset.soil), 996.5) << preset.name;
  }
}

TEST(Cohesion, DoesNotDependOnTheStiffness) {
  SoilParameters soil = findPreset("P1").soil;
  const double with_spring = cohesion(soil);
  soil.stiffness_n_m = std::numeric_limits<double>::infinity();
  EXPECT_EQ(cohesion(soil), with_spring);
}

TEST(Cohesion, IsProportionalToGammaAndFriction) {
  SoilParameters soil = findPreset("P1").soil;
  const double before = cohesion(soil);
  soil.gamma_nm *= 2;
  soil.mu_hat *= 3;
  EXPECT_NEAR(cohesion(soil), 6 * before, 1e-9);
}

TEST(Cohesion, IsRefusedForSoilThatCannotBeCompactedThatFar) {
  SoilParameters soil = findPreset("P1").soil;
  soil.rho_max_kg_m3 = 1500;  // a_min would be larger than a_1
  EXPECT_THROW(static_cast<void>(cohesion(soil)), InvalidParameter);
  soil.rho0_kg_m3 = 1967;  // denser than rho_1 from the start
  soil.rho_max_kg_m3 = 2500;
  EXPECT_THROW(static_cast<void>(cohesion(soil)), InvalidParameter);
  soil.rho0_kg_m3 = 378;  // a_1 would be below 2R / sqrt(3)
  EXPECT_THROW(static_cast<void>(cohesion(soil)), InvalidParameter);
}

TEST(LeastCompactableRhoMax, LeavesTheWantedPartOfTheWay) {
  for (const double overlap : {0.3, 0.6, 0.9}) {
    SoilParameters soil = findPreset("P3").soil;
    soil.rho_max_kg_m3 = leastCompactableRhoMax(soil.rho0_kg_m3, overlap);
    const double ratio = soil.rho0_kg_m3 / soil.rho_max_kg_m3;
    const double a_min = soil.radius_m * std::sqrt(8.0 / 3 * ratio * ratio + 4.0 / 3);
    EXPECT_NEAR((2 * soil.radius_m - compactedDistance(soil)) / (2 * soil.radius_m - a_min), overlap, 1e-12);
  }
}

}  // namespace
}  // namespace haptolith
