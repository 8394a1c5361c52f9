#include "haptolith/exchange/lammps_law.h"

#include <gmock/gmock.h>

#include <cmath>

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
  EXPECT_FALSE(law.grains.coheres);
  EXPECT_EQ(law.smaller_m, 0);
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

TEST(GranularLaw, IsTheNearestLineForOtherSoil) {
  SoilParameters soil = springs();
  soil.gamma_nm /= 20;
  BedParameters parameters = bedOf(soil);
  parameters.depth_m = 0.2;
  const Bed bed(parameters);
  const GranularLaw law = granularLaw(bed);
  EXPECT_FALSE(law.exact);
  EXPECT_FALSE(law.grains.coheres);
  EXPECT_GT(law.smaller_m, 0);  // a hyperbola bends upwards: the line begins later
  EXPECT_LT(law.smaller_m, 0.1 * soil.radius_m);
  EXPECT_LT(law.grains.stiffness, soil.stiffness_n_m);
  EXPECT_GT(law.grains.stiffness, soil.gamma_nm / std::pow(2 * soil.radius_m - bed.law().a_min_m, 2));
  EXPECT_LT(law.spread_of_fit, 0.1);
}

TEST(GranularLaw, CoheresAsTheSoilDoes) {
  SoilParameters soil = springs();  // those of lunar-0-15cm
  soil.gamma_nm = 6e-5;
  soil.rho0_kg_m3 = 1400;
  soil.rho_max_kg_m3 = 1801.4;
  soil.stiffness_n_m = 3000;
  soil.contact_cohesion_n = 0.24;
  BedParameters parameters = bedOf(soil);
  parameters.gravity_m_s2 = {0, 0, -60};  // pressed as in a test under load
  const Bed bed(parameters);
  const GranularLaw law = granularLaw(bed);
  EXPECT_FALSE(law.exact);
  EXPECT_TRUE(law.grains.coheres);
  EXPECT_DOUBLE_EQ(law.grains.pull_n, 0.12);
  EXPECT_THAT(law.grains.text(), HasSubstr("jkr "));
  EXPECT_LT(law.spread_of_fit, 0.2);
  EXPECT_DOUBLE_EQ(law.wall.pull_n, law.grains.pull_n);
}

TEST(JkrForce, IsWhatLammpsGives) {
  // `pair_coeff * * jkr 484403 0.36 0 3.72`, two spheres of 7 mm that overlap by 0.1 mm, LAMMPS of 29 September 2021.
  const double pull_n = 3 * M_PI * 3.72 * 3.5e-3;
  EXPECT_NEAR(jkrForce(1e-4, 484403.0 / 2, pull_n, 3.5e-3), -0.081185035, 1e-8);
  // fix wall/gran granular with the same numbers, 0.05 mm in it.
  EXPECT_NEAR(jkrForce(5e-5, 484403.0 / 2, 2 * pull_n, 7e-3), -0.19894836, 1e-7);
}

TEST(JkrForce, IsHertzWithoutAPull) {
  for (const double overlap_m : {1e-6, 1e-4, 1e-3}) {
    EXPECT_NEAR(jkrForce(overlap_m, 1e6, 0, 3e-3), 4.0 / 3 * 1e6 * std::sqrt(3e-3) * std::pow(overlap_m, 1.5), 1e-9);
  }
}

TEST(JkrForce, OfAWallIsThatOfAMirrorImage) {
  // Twice as stiff, the same pull, twice the effective radius, half the overlap.
  for (const double overlap_m : {0.0, 1e-5, 1e-4, 1e-3}) {
    const double pair_n = jkrForce(overlap_m, 3e5, 0.1, 3.5e-3);
    EXPECT_NEAR(jkrForce(overlap_m / 2, 6e5, 0.1, 7e-3), pair_n, 1e-9 + 1e-9 * std::abs(pair_n));
  }
}

TEST(GranularLaw, HasARestitutionForEveryDamping) {
  for (const double zeta : {0.02, 0.1, 0.2, 0.35, 0.5}) {
    const double e = restitutionOf(zeta);
    // Tsuji, Tanaka and Ishida's damping as LAMMPS has it, a polynomial of sixth order.
    const double alpha = 1.2728 - 4.2783 * e + 11.087 * e * e - 22.348 * std::pow(e, 3) + 27.467 * std::pow(e, 4) -
                         18.022 * std::pow(e, 5) + 4.8218 * std::pow(e, 6);
    EXPECT_NEAR(alpha, 2 * zeta * std::sqrt(1.5), 1e-9) << zeta;
    EXPECT_GT(e, 0);
    EXPECT_LT(e, 1);
  }
  EXPECT_GT(restitutionOf(0.1), restitutionOf(0.2));
}

TEST(GranularLaw, RefusesWhatNoStyleHas) {
  BedParameters paper;
  EXPECT_THROW((void)granularLaw(Bed(paper)), InvalidParameter);
  BedParameters graded = bedOf(springs());
  graded.grading.fine_radius_m = graded.soil.radius_m / 2;
  graded.width_m = graded.length_m = 0.1;
  graded.grading.fine_width_m = graded.grading.fine_length_m = 0.03;
  EXPECT_THROW((void)granularLaw(Bed(graded)), InvalidParameter);
  BedParameters stony = bedOf(springs());
  stony.stones.count = 1;
  EXPECT_THROW((void)granularLaw(Bed(stony)), InvalidParameter);
}

TEST(GranularLaw, IsSoftAgainstATool) {
  ToolParameters tool;
  tool.friction = 0.36;
  const GranularContact contact = granularContact(tool, springs(), 2e-4);
  EXPECT_DOUBLE_EQ(contact.stiffness, tool.stiffness_n_m);
  EXPECT_DOUBLE_EQ(contact.damping_n_s_m, 1.4 * 2e-4 * tool.stiffness_n_m / 2);
  EXPECT_DOUBLE_EQ(contact.across_n_m, tool.stiffness_n_m / 2);
  EXPECT_DOUBLE_EQ(contact.friction, 0.36);
}

}  // namespace
}  // namespace haptolith
