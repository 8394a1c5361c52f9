#include "haptolith/lammps/lammps_law.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>

#include "haptolith/core/error.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {
namespace {

using testing::HasSubstr;

/// Soil whose contact is a spring: what `granular` has exactly.
SoilParameters springs() {
  SoilParameters soil;
  soil.friction = FrictionModel::kContact;
  soil.stiffness_n_m = 1000;
  soil.attraction_ratio = 1;
  soil.gamma_nm = linearGamma(soil);
  return soil;
}

BedParameters bedOf(const SoilParameters& soil) {
  BedParameters bed;
  bed.soil = soil;
  bed.start = BedStart::kPacked;
  return bed;
}

TEST(GranularLaw, IsTheSameForSprings) {
  const SoilParameters soil = springs();
  const Bed bed(bedOf(soil));
  const GranularLaw law = granularLaw(bed);
  EXPECT_TRUE(law.exact);
  EXPECT_EQ(law.spread_of_fit, 0);
  EXPECT_FALSE(law.grains.hertz);
  EXPECT_EQ(law.larger_m, 0);
  EXPECT_EQ(law.wall_behind_m, 0);
  EXPECT_DOUBLE_EQ(law.grains.stiffness, 1000);
  EXPECT_DOUBLE_EQ(law.grains.across_n_m, 500);
  // zeta of the critical damping of a pair that bounces: 2 sqrt(m/2 k).
  EXPECT_NEAR(law.grains.damping_n_s_m, 0.2 * 2 * std::sqrt(bed.mass() / 2 * 1000), 1e-12);
  EXPECT_THAT(law.grains.text(), HasSubstr("hooke 1000 "));
  EXPECT_THAT(law.grains.text(), HasSubstr(" damping velocity tangential linear_history 500 "));
  EXPECT_THAT(law.grains.text(), HasSubstr(" 0.5 limit_damping"));
}

TEST(GranularLaw, HasTheWallAsAMirror) {
  const Bed bed(bedOf(springs()));
  const GranularLaw law = granularLaw(bed);
  // A grain that stands d into a wall stands 2 d into its image, which comes twice as fast and slides as fast as it.
  EXPECT_DOUBLE_EQ(law.wall.stiffness, 2 * law.grains.stiffness);
  EXPECT_DOUBLE_EQ(law.wall.damping_n_s_m, 2 * law.grains.damping_n_s_m);
  EXPECT_DOUBLE_EQ(law.wall.across_n_m, law.grains.across_n_m);
  EXPECT_DOUBLE_EQ(law.wall.across_damping * law.wall.damping_n_s_m,
                   law.grains.across_damping * law.grains.damping_n_s_m);
}

/// Soil without an exact law in LAMMPS: that of lunar-0-15cm, with cohesion or without.
BedParameters lunar(double cohesion_n) {
  SoilParameters soil = springs();
  soil.gamma_nm = 6e-5;
  soil.rho0_kg_m3 = 1400;
  soil.rho_max_kg_m3 = 1801.4;
  soil.stiffness_n_m = 3000;
  soil.contact_cohesion_n = cohesion_n;
  BedParameters parameters = bedOf(soil);
  parameters.gravity_m_s2 = {0, 0, -60};  // pressed as in a test under load
  return parameters;
}

double hertz(const GranularLaw& law, const ContactLaw& contact, double distance_m) {
  const double radii_m = contact.diameter_m + 2 * law.larger_m;
  const double overlap_m = std::max(0.0, radii_m - distance_m);
  return law.grains.stiffness * std::sqrt(radii_m / 4) * std::pow(overlap_m, 1.5);
}

TEST(GranularLaw, IsWithItsTableTheLawAlongTheNormal) {
  for (const double cohesion_n : {0.0, 0.24}) {
    const Bed bed(lunar(cohesion_n));
    const GranularLaw law = granularLaw(bed);
    EXPECT_FALSE(law.exact);
    EXPECT_TRUE(law.grains.hertz);
    for (double a_m = 0.011; a_m < bed.law().cutoff_m; a_m += 1e-4) {
      EXPECT_NEAR(hertz(law, bed.law(), a_m) + restForce(law, bed.law(), 0, a_m), contactForce(bed.law(), a_m), 1e-9);
    }
    // Larger particles have the same law at a larger distance, except for their curvature.
    EXPECT_NEAR(restForce(law, bed.law(), 1e-3, 0.0135 + 1e-3), restForce(law, bed.law(), 0, 0.0135), 0.02);
    EXPECT_EQ(restForce(law, bed.law(), 0, bed.law().cutoff_m + 2e-3), 0);
  }
}

TEST(GranularLaw, OfItsOwnEndsWhereTheBedsDoes) {
  // Also the damper: without cohesion an approaching particle is braked in contact only.
  const Bed with_cohesion(lunar(0.24)), without(lunar(0));
  for (const Bed* bed : {&with_cohesion, &without}) {
    const GranularLaw law = granularLaw(*bed, LammpsLaw::kHaptolith);
    const double reach_m = bed->law().cutoff_m - bed->law().diameter_m;
    EXPECT_DOUBLE_EQ(law.own->reach_m, reach_m);
    EXPECT_DOUBLE_EQ(2 * law.larger_m, reach_m);
    double diameter_m = 0, a_min_m = 0, gamma_nm = 0, k_n_m = 0, pull_n = 0, written_m = 0;
    ASSERT_EQ(std::sscanf(law.betweenGrains().c_str(), "haptolith %lf %lf %lf %lf %lf %lf", &diameter_m, &a_min_m,
                          &gamma_nm, &k_n_m, &pull_n, &written_m),
              6);
    EXPECT_NEAR(written_m, reach_m, 1e-12);
  }
  EXPECT_EQ(granularLaw(without, LammpsLaw::kHaptolith).own->reach_m, 0);
}

TEST(GranularLaw, LimitsFrictionByAboutWhatTheSoilDoes) {
  const Bed with_cohesion(lunar(0.24)), without(lunar(0));
  const GranularLaw coheres = granularLaw(with_cohesion), slides = granularLaw(without);
  EXPECT_LT(coheres.spread_of_fit, 0.35);
  EXPECT_LT(slides.spread_of_fit, 0.35);
  EXPECT_GT(coheres.larger_m, 0) << "cohesion limits friction before grains touch";
  EXPECT_LT(slides.larger_m, 0) << "a hyperbola bends upwards, so Hertz' law begins later";
  // Grains that just touch: F_c, and nothing.
  const double touch_m = with_cohesion.law().diameter_m;
  EXPECT_NEAR(hertz(coheres, with_cohesion.law(), touch_m), 0.24, 0.12);
  EXPECT_EQ(hertz(slides, without.law(), touch_m), 0);
}

TEST(GranularLaw, HasAWallThatBeginsWhereGrainsDo) {
  const Bed bed(lunar(0.24));
  const GranularLaw law = granularLaw(bed);
  EXPECT_FALSE(law.wall.hertz);
  EXPECT_LE(law.wall.stiffness, 2 * bed.parameters().soil.stiffness_n_m);
  // The spheres are larger than the grains, and the wall stands back by at least as much.
  EXPECT_GE(law.wall_behind_m, law.larger_m);
  EXPECT_LT(law.wall_behind_m, law.larger_m + 0.2 * bed.parameters().soil.radius_m);
}

TEST(GranularLaw, HasALawForSoilThatDoesNotLieYet) {
  BedParameters two = lunar(0.24);
  two.start = BedStart::kRain;
  two.particles = 2;
  BedParameters many = lunar(0.24);  // that cohere across gaps and do not touch
  many.start = BedStart::kPacked;
  many.gravity_m_s2 = Vec3::Zero();
  for (const BedParameters& loose : {two, many}) {
    const GranularLaw law = granularLaw(Bed(loose));
    EXPECT_GT(law.grains.stiffness, 0);
    EXPECT_GT(law.wall.stiffness, 0);
    EXPECT_TRUE(std::isfinite(law.wall_behind_m));
  }
}

TEST(GranularLaw, RefusesWhatNoStyleHas) {
  BedParameters icra2021;
  EXPECT_THROW((void)granularLaw(Bed(icra2021)), InvalidParameter);
  BedParameters graded = bedOf(springs());
  graded.grading.fine_radius_m = graded.soil.radius_m / 2;
  graded.width_m = graded.length_m = 0.1;
  graded.grading.fine_width_m = graded.grading.fine_length_m = 0.03;
  EXPECT_THROW((void)granularLaw(Bed(graded)), InvalidParameter);
  BedParameters stony = bedOf(springs());
  stony.stones.count = 1;
  EXPECT_THROW((void)granularLaw(Bed(stony)), InvalidParameter);
}

TEST(GranularLaw, IsTogetherAsStiffAsTheTool) {
  ToolParameters tool;
  tool.friction = 0.36;
  const SpheresUnderAGrain spheres{.count = 4, .depth_m = 2e-3, .pressed_m = 0.5e-3};
  const GranularContact contact = granularContact(tool, springs(), 2e-4, spheres);
  EXPECT_DOUBLE_EQ(contact.stiffness * spheres.depth_m, tool.stiffness_n_m * spheres.pressed_m);
  EXPECT_DOUBLE_EQ(contact.damping_n_s_m, 1.4 * 2e-4 * contact.stiffness / 2);
  EXPECT_DOUBLE_EQ(contact.across_n_m * spheres.count, tool.stiffness_n_m / 2);
  EXPECT_DOUBLE_EQ(contact.friction, 0.36);
}

}  // namespace
}  // namespace haptolith
