#include "haptolith/soil/contact_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "haptolith/core/error.h"
#include "haptolith/soil/presets.h"
#include "haptolith/soil/printed_law.h"

namespace haptolith {
namespace {

TEST(ContactLaw, IsTheEquationForEveryPreset) {
  for (const Preset& preset : presets()) {
    const ContactLaw law = makeContactLaw(preset.soil);
    for (double a = 0.5 * preset.soil.radius_m; a < 2.5 * preset.soil.radius_m; a += 1e-5) {
      EXPECT_NEAR(contactForce(law, a), printedForce(preset.soil, a), 1e-12) << preset.name << " at " << a;
    }
  }
}

TEST(ContactLaw, LeastDistanceGivesTheDensestLattice) {
  // At b_min = b(0) rho0 / rho_max the density is rho_max; a_min is the distance that belongs to it.
  for (const Preset& preset : presets()) {
    const SoilParameters& soil = preset.soil;
    const double b_min = 2 * std::sqrt(2.0 / 3) * soil.radius_m * soil.rho0_kg_m3 / soil.rho_max_kg_m3;
    const double a_min = std::hypot(b_min, 2 * soil.radius_m / std::sqrt(3.0));
    EXPECT_NEAR(makeContactLaw(soil).a_min_m, a_min, 1e-15);
  }
}

TEST(ContactLaw, ValueAndSlopeAreContinuousAtTheThreshold) {
  for (const Preset& preset : presets()) {
    const ContactLaw law = makeContactLaw(preset.soil);
    const double step = 1e-8;
    const double below = contactForce(law, law.a_thr_m - step);
    const double at = contactForce(law, law.a_thr_m);
    const double above = contactForce(law, law.a_thr_m + step);
    EXPECT_NEAR((at - below) / step, -law.stiffness_n_m, 1e-4 * law.stiffness_n_m);
    EXPECT_NEAR((above - at) / step, -law.stiffness_n_m, 1e-4 * law.stiffness_n_m);
  }
}

TEST(ContactLaw, TouchingParticlesFeelNothing) {
  for (const Preset& preset : presets()) {
    EXPECT_NEAR(contactForce(makeContactLaw(preset.soil), 2 * preset.soil.radius_m), 0, 1e-15);
  }
}

TEST(ContactLaw, RepelsInsideAttractsOutsideAndEndsAtTheCutoff) {
  const SoilParameters soil = findPreset("P3").soil;
  const ContactLaw law = makeContactLaw(soil);
  const double diameter = 2 * soil.radius_m;
  EXPECT_GT(contactForce(law, 0.999 * diameter), 0);
  EXPECT_LT(contactForce(law, 1.001 * diameter), 0);
  EXPECT_LT(contactForce(law, 1.0999 * diameter), 0);
  EXPECT_EQ(contactForce(law, law.cutoff_m), 0);
  EXPECT_EQ(contactForce(law, 5 * diameter), 0);
}

TEST(ContactLaw, WithoutAttractionEndsWhereParticlesPart) {
  SoilParameters soil = findPreset("P3").soil;
  soil.attraction_ratio = 1;
  const ContactLaw law = makeContactLaw(soil);
  EXPECT_EQ(contactForce(law, 2.0001 * soil.radius_m), 0);
  EXPECT_GT(contactForce(law, 1.9999 * soil.radius_m), 0);
}

TEST(ContactLaw, ForceFallsWithDistance) {
  const ContactLaw law = makeContactLaw(findPreset("P1").soil);
  double before = contactForce(law, 0);
  for (double a = 1e-5; a < law.cutoff_m; a += 1e-5) {
    const double force = contactForce(law, a);
    EXPECT_LT(force, before);
    before = force;
  }
}

TEST(ContactLaw, InfiniteStiffnessIsTheHyperbolaAlone) {
  SoilParameters soil = findPreset("P3").soil;
  soil.stiffness_n_m = std::numeric_limits<double>::infinity();
  const ContactLaw law = makeContactLaw(soil);
  const double a = law.a_min_m + 1e-6;
  EXPECT_NEAR(contactForce(law, a), soil.gamma_nm / 1e-6 - law.h_n, 1e-6);
}

// --- with contact friction
// --------------------------------------------------------------------------------------------

SoilParameters contactFriction(double cohesion_n) {
  SoilParameters soil = findPreset("P3").soil;
  soil.friction = FrictionModel::kContact;
  soil.contact_cohesion_n = cohesion_n;
  return soil;
}

TEST(ContactFrictionLaw, RepelsLikeThePapersAndPullsHardestHalfwayAcrossItsRange) {
  // R = 7 mm: range 2.8 mm, the largest pull at 15.4 mm, none at 14 and from 16.8 mm on.
  const ContactLaw law = makeContactLaw(contactFriction(0.03));
  for (double a = 0.008; a < 0.014; a += 1e-5) {
    EXPECT_NEAR(contactForce(law, a), printedForce(findPreset("P3").soil, a), 1e-12) << a;
  }
  EXPECT_NEAR(contactForce(law, 0.0154), -0.03, 1e-12);
  EXPECT_NEAR(contactForce(law, 0.0147), -0.0225, 1e-12);  // 4 F_c / 4 * 3 / 4
  EXPECT_NEAR(contactForce(law, 0.014), 0, 1e-12);
  EXPECT_NEAR(contactForce(law, 0.0168 - 1e-9), 0, 1e-6);
  EXPECT_EQ(contactForce(law, 0.0168 + 1e-9), 0);
  EXPECT_EQ(contactForce(makeContactLaw(contactFriction(0)), 0.01401), 0);
}

TEST(ContactLaw, WithLinearGammaIsALinearSpring) {
  SoilParameters soil = contactFriction(0);
  soil.stiffness_n_m = 6000;
  soil.gamma_nm = linearGamma(soil);
  const ContactLaw law = makeContactLaw(soil);
  for (double a = 0.005; a < 0.014; a += 1e-5) {
    ASSERT_NEAR(contactForce(law, a), 6000 * (0.014 - a), 1e-6) << a;
  }
}

TEST(ContactLaw, RefusesAGammaThatDoublesDoNotResolve) {
  SoilParameters soil = contactFriction(0);
  soil.stiffness_n_m = 6000;
  const double a_min_m = makeContactLaw(soil).a_min_m;
  soil.gamma_nm = 1.01 * 6000 * a_min_m * a_min_m * 1e-18;
  const ContactLaw law = makeContactLaw(soil);
  EXPECT_TRUE(std::isfinite(contactForce(law, law.a_thr_m)));
  EXPECT_NO_THROW(requireHyperbola(law, 1e-9));
  EXPECT_THROW(requireHyperbola(law, 1e-5), InvalidParameter);
  for (const double share : {0.98, 1e-10, 1e-300}) {
    SoilParameters less = soil;
    less.gamma_nm *= share;
    EXPECT_THROW(static_cast<void>(makeContactLaw(less)), InvalidParameter) << share;
    EXPECT_NO_THROW(static_cast<void>(linearGamma(less))) << "which does not ask for gamma";
  }
}

TEST(ContactLaw, StaysASpringWithAnotherStiffnessIfItIsOne) {
  SoilParameters soil = contactFriction(0);
  const SoilParameters yielding = withStiffness(soil, 2 * soil.stiffness_n_m);
  EXPECT_EQ(yielding.stiffness_n_m, 2 * soil.stiffness_n_m);
  EXPECT_EQ(yielding.gamma_nm, soil.gamma_nm);
  soil.gamma_nm = linearGamma(soil);
  for (const double times : {0.5, 2.0}) {
    const SoilParameters spring = withStiffness(soil, times * soil.stiffness_n_m);
    EXPECT_DOUBLE_EQ(contactForce(makeContactLaw(spring), 0.0135), times * contactForce(makeContactLaw(soil), 0.0135));
  }
}

TEST(ContactLaw, EnergyIsTheIntegralOfTheForce) {
  SoilParameters icra2021 = findPreset("P3").soil;
  for (const SoilParameters& soil : {icra2021, contactFriction(0), contactFriction(0.03)}) {
    const ContactLaw law = makeContactLaw(soil);
    EXPECT_EQ(contactEnergy(law, law.cutoff_m), 0);
    double work = 0;
    constexpr double kStep_m = 1e-7;
    for (double a = law.cutoff_m - kStep_m / 2; a > 0.009; a -= kStep_m) {  // midpoints
      work += kStep_m * contactForce(law, a);
      ASSERT_NEAR(contactEnergy(law, a - kStep_m / 2), work, 1e-9) << a;
    }
  }
}

}  // namespace
}  // namespace haptolith
