#include "haptolith/bed/critical_step.h"

#include <gmock/gmock.h>

#include <cmath>

#include "haptolith/bed/bed.h"
#include "haptolith/core/error.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

TEST(CriticalStep, WithIcra2021FrictionItIsTheFrequencyOfAParticleBetweenItsNeighboursTheWallAndTheTool) {
  // P4: m = 4 sqrt(2) * 1360 * 0.007^3 = 2.63881e-3 kg; (10 * 100 + 500) / m = 5.6844e5 1/s^2; its root 753.95 rad/s.
  EXPECT_NEAR(stepsPerSecond(findPreset("P4").soil, 500), 753.95, 0.01);
  EXPECT_NEAR(stepsPerSecond(findPreset("P4").soil, 0), 615.60, 0.01);
}

TEST(CriticalStep, ThePapersSceneNeedsOneStepATick) {
  for (const Preset& preset : presets()) {
    EXPECT_EQ(substepsFor(preset.soil, 500, 1e-3, 32), 1) << preset.name;
  }
}

TEST(CriticalStep, SubstepsAreThePhaseOfATickRoundedUp) {
  const SoilParameters soil = findPreset("P4").soil;
  EXPECT_EQ(substepsFor(soil, 500, 2e-3, 32), 2);   // 1.508
  EXPECT_EQ(substepsFor(soil, 500, 10e-3, 32), 8);  // 7.539
  EXPECT_EQ(substepsFor(soil, 5000, 1e-3, 32), 2);  // sqrt(6000 / m) = 1507.9
  EXPECT_EQ(substepsFor(soil, 500, 1e-6, 32), 1);
  // Smaller particles: k ~ R and m ~ R^3, so omega ~ 1/R. R = 1 mm: sqrt((10 * 100/7 + 500) / 7.6933e-6) = 9141 rad/s.
  EXPECT_EQ(substepsFor(rescaled(soil, 1e-3), 500, 1e-3, 32), 10);
}

/// As soils/lunar-0-15cm.toml.
SoilParameters lunarSoil() {
  SoilParameters soil;
  soil.gamma_nm = 6e-5;
  soil.rho0_kg_m3 = 1400;
  soil.rho_max_kg_m3 = 1801.4;
  soil.stiffness_n_m = 3000;
  soil.friction = FrictionModel::kContact;
  soil.contact_cohesion_n = 0.2455;
  soil.size_spread = 0.15;
  return soil;
}

TEST(CriticalStep, LunarSoilUnderAShovelNeedsThreeStepsATick) {
  // m = 2.7164e-3 kg, sqrt(k / m) = 1050.9 /s. Springs 10.2; dampers 2 sqrt(2) 0.2 * 12.561 = 7.1056, as 12.561 =
  // 10.2 + 11.4 (sqrt(1/2) - 1/2); a shovel of 500 N/m, 1200 N/m with its damper. With q = 1050.9 dt:
  // 10.2 q^2 + 7.1056 q + 1200 / 3000 q^2 = 4 at q = 0.36461, and so 1050.9 / 0.36461 = 2882.2 steps a second.
  const SoilParameters soil = lunarSoil();
  EXPECT_NEAR(stepsPerSecond(soil, 1200), 2882.2, 1);
  EXPECT_EQ(substepsFor(soil, 1200, 1e-3, 32), 3);
  EXPECT_NEAR(stepsPerSecond(rescaled(soil, 3.5e-3), 600), 2 * 2882.2, 2);  // everything goes with 1/R
  // Without damping accuracy decides: sqrt(10.2 + 0.4) q = 0.8.
  SoilParameters undamped = soil;
  undamped.damping_ratio = 0;
  EXPECT_NEAR(stepsPerSecond(undamped, 1200), 1050.9 * std::sqrt(10.6) / 0.8, 1);
}

TEST(CriticalStep, NamesTheStiffnessThatWouldDoWithContactFrictionToo) {
  SoilParameters soil = lunarSoil();
  soil.contact_cohesion_n = 0;
  try {
    (void)substepsFor(soil, 1200, 1e-3, 2);
    FAIL();
  } catch (const InvalidParameter& error) {
    const std::string text = error.what();
    const std::size_t at = text.find("<= ");
    ASSERT_NE(at, std::string::npos) << text;
    soil.stiffness_n_m = std::stod(text.substr(at + 3));
    EXPECT_GT(soil.stiffness_n_m, 500);
  }
  soil.stiffness_n_m *= 0.999;
  EXPECT_EQ(substepsFor(soil, 1200, 1e-3, 2), 2);
  soil.stiffness_n_m *= 1.002;
  EXPECT_THROW((void)substepsFor(soil, 1200, 1e-3, 2), InvalidParameter);
  EXPECT_THROW((void)substepsFor(soil, 1e6, 1e-3, 2), InvalidParameter);  // the tool alone
}

TEST(CriticalStep, RefusesASceneThatIsHopelessAndNamesTheStiffnessThatWouldDo) {
  const SoilParameters soil = rescaled(findPreset("P4").soil, 1e-3);
  try {
    (void)substepsFor(soil, 0, 1e-3, 2);
    FAIL() << "4.3 substeps do not fit into 2";
  } catch (const InvalidParameter& error) {
    EXPECT_EQ(error.key(), "stiffness_n_m");
    // (2 / 1 ms)^2 m / 10 = 3.077 N/m
    EXPECT_THAT(error.what(), testing::HasSubstr("3.077"));
    EXPECT_THAT(error.what(), testing::HasSubstr("max_substeps = 2"));
  }
  SoilParameters softer = soil;
  softer.stiffness_n_m = 3.077;
  EXPECT_EQ(substepsFor(softer, 0, 1e-3, 2), 2);  // and it does
}

TEST(CriticalStep, SaysWhenNoSoilIsSoftEnoughForTheTool) {
  try {
    (void)substepsFor(findPreset("P4").soil, 1e6, 1e-3, 4);
    FAIL();
  } catch (const InvalidParameter& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("softer tool"));
  }
}

TEST(CriticalStep, AnInfiniteStiffnessIsRefused) {
  SoilParameters soil = findPreset("P4").soil;
  soil.stiffness_n_m = std::numeric_limits<double>::infinity();
  EXPECT_THROW((void)substepsFor(soil, 0, 1e-3, 32), InvalidParameter);
}

/// Height that a lone particle without gravity reaches within `steps` steps when it starts pressed 2 mm into the floor.
double rebound(double dt_s, int steps) {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  bed.soil.mu_hat = 0;
  bed.gravity_m_s2 = {0, 0, -9.81};
  Bed alone(bed, {Vec3(0, 0, 0.005)});
  double highest = 0;
  for (int i = 0; i < steps && alone.step(dt_s) == StepStatus::kOk; ++i) {
    highest = std::max(highest, std::abs(static_cast<double>(alone.state().position[0].z)));
  }
  return highest;
}

TEST(CriticalStep, IsStableAtTheStepItGivesAndNotFarAboveIt) {
  // A particle on the floor hangs on a spring of at most 2 k, with the damping of one contact (paper 20), c = k dt / 2.
  // With y = k dt^2 / m the semi-implicit step is stable for 2 y < 4 + y, so y < 4: dt < 2 sqrt(m / k) = 10.3 ms.
  const SoilParameters soil = findPreset("P4").soil;
  const double given = 1 / stepsPerSecond(soil, 0);
  EXPECT_LT(rebound(given, 2000), 0.05);
  const double unstable = 4 * std::sqrt(macroparticleMass(soil) / soil.stiffness_n_m);
  EXPECT_GT(unstable, 10 * given);
  EXPECT_GT(rebound(unstable, 200), 0.2);
}

}  // namespace
}  // namespace haptolith
