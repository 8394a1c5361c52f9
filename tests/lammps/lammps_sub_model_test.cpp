// extras/lammps compared with the bed's own law, contact by contact.

#include "lammps_sub_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/lammps/lammps_law.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {
namespace {

BedParameters cohesive() {
  BedParameters bed;
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.contact_cohesion_n = 0.02;
  bed.start = BedStart::kPacked;
  return bed;
}

/// The numbers of `pair_coeff * * haptolith ...` as LAMMPS reads them.
struct Coefficients {
  std::vector<double> normal, across;
};
Coefficients coefficientsOf(const std::string& text) {
  std::istringstream words(text);
  Coefficients all;
  std::vector<double>* numbers = &all.normal;
  for (std::string word; words >> word;) {
    if (word == "tangential") {
      numbers = &all.across;
    } else if (word != "haptolith" && word != "damping" && word != "velocity") {
      numbers->push_back(std::stod(word));
    }
  }
  return all;
}

class LammpsSubModel : public testing::Test {
 protected:
  Bed bed_{cohesive()};
  GranularLaw law_ = granularLaw(bed_, LammpsLaw::kHaptolith);
  Coefficients numbers_ = coefficientsOf(law_.betweenGrains());
  double diameter_m_ = bed_.law().diameter_m, more_m_ = 2 * law_.larger_m;

  [[nodiscard]] SubModelContact at(double a_m, double excess_m = 0) const {
    return {.radii_m = diameter_m_ + excess_m + more_m_, .distance_m = a_m + excess_m, .dt_s = 2e-4};
  }
};

TEST_F(LammpsSubModel, IsTheLawAlongTheNormalForGrainsOfAnySize) {
  std::array<double, 3> stretch{};
  for (const double excess_m : {-2e-3, 0.0, 1e-3}) {
    for (double a_m = 0.85 * diameter_m_; a_m < 1.3 * diameter_m_; a_m += 1e-5) {
      const SubModelForce force = subModelForce(numbers_.normal, numbers_.across, at(a_m, excess_m), stretch);
      EXPECT_EQ(force.touches, a_m < bed_.law().cutoff_m) << a_m;
      if (force.touches) {
        EXPECT_NEAR(force.normal_n, contactForce(bed_.law(), a_m), 1e-7) << a_m;
      }
    }
  }
}

TEST_F(LammpsSubModel, DampsApproachAndPartingAndNeverPulls) {
  std::array<double, 3> stretch{};
  const SoilParameters& soil = bed_.parameters().soil;
  for (const double share : {0.9, 0.99, 1.02}) {
    const double a_m = share * diameter_m_, step_m = 1e-9;
    const double still_n = contactForce(bed_.law(), a_m);
    const double stiffness =
        -(contactForce(bed_.law(), a_m + step_m) - contactForce(bed_.law(), a_m - step_m)) / (2 * step_m);
    for (const double parting : {-0.01, 1e-4, 10.0}) {
      SubModelContact contact = at(a_m);
      contact.parting_m_s = parting;
      const double force_n = subModelForce(numbers_.normal, numbers_.across, contact, stretch).normal_n;
      if (share < 1) {  // zeta of critical of the stiffness that the contact has just now
        const double wanted_n = still_n - soil.damping_ratio * std::sqrt(2 * bed_.mass() * stiffness) * parting;
        EXPECT_NEAR(force_n, std::max(wanted_n, 0.0), 1e-4 * std::abs(wanted_n)) << share << ' ' << parting;
      } else {
        EXPECT_GE(force_n, still_n);
      }
    }
  }
}

TEST(LammpsSubModelWithoutCohesion, BrakesNothingBeforeItTouches) {
  BedParameters parameters = cohesive();
  parameters.soil.contact_cohesion_n = 0;
  const Bed bed(parameters);
  const Coefficients numbers = coefficientsOf(granularLaw(bed, LammpsLaw::kHaptolith).betweenGrains());
  std::array<double, 3> stretch{};
  const auto force_at = [&](double a_m) {
    const SubModelContact contact{
        .radii_m = bed.law().diameter_m, .distance_m = a_m, .parting_m_s = -0.1, .dt_s = 2e-4};
    return subModelForce(numbers.normal, numbers.across, contact, stretch);
  };
  EXPECT_FALSE(force_at(1.001 * bed.law().diameter_m).touches);
  EXPECT_GT(force_at(0.999 * bed.law().diameter_m).normal_n, contactForce(bed.law(), 0.999 * bed.law().diameter_m));
}

TEST_F(LammpsSubModel, HoldsFrictionByRepulsionAndCohesion) {
  const SoilParameters& soil = bed_.parameters().soil;
  const double k_t = soil.tangential_ratio * soil.stiffness_n_m;
  const double touching_n = contactForce(bed_.law(), 0.95 * diameter_m_) + soil.contact_cohesion_n;
  SubModelContact contact = at(0.95 * diameter_m_);
  std::array<double, 3> stretch{1e-7, 2e-7, 0};
  const SubModelForce sticks = subModelForce(numbers_.normal, numbers_.across, contact, stretch);
  EXPECT_NEAR(stretch[0], 0, 1e-15);  // its part along the normal is dropped
  EXPECT_NEAR(sticks.across_n[1], -k_t * 2e-7, 1e-9);
  contact.slip_m_s = {0, 3, 4};
  const SubModelForce slides = subModelForce(numbers_.normal, numbers_.across, contact, stretch);
  EXPECT_NEAR(std::hypot(slides.across_n[1], slides.across_n[2]), soil.contact_friction * touching_n, 1e-7);
  EXPECT_LT(slides.across_n[2], 0);
  EXPECT_NEAR(k_t * std::hypot(stretch[1], stretch[2]), soil.contact_friction * touching_n, 1e-7);  // no damper in it
  contact = at(diameter_m_ + 0.75 * bed_.law().cohesion_range_m);
  contact.slip_m_s = {0, 3, 4};
  const SubModelForce apart = subModelForce(numbers_.normal, numbers_.across, contact, stretch);
  EXPECT_NEAR(std::hypot(apart.across_n[1], apart.across_n[2]), 0, 1e-12);  // nothing holds it from halfway on
}

TEST_F(LammpsSubModel, HasTheWallAsAMirror) {
  std::array<double, 3> stretch{};
  for (const double share : {0.93, 0.99, 1.05}) {
    SubModelContact contact{.wall = true,
                            .radii_m = (diameter_m_ + more_m_) / 2,
                            .distance_m = share * diameter_m_ / 2,
                            .parting_m_s = 0.001,
                            .dt_s = 2e-4};
    const double at_wall = subModelForce(numbers_.normal, numbers_.across, contact, stretch).normal_n;
    SubModelContact image = at(share * diameter_m_);
    image.parting_m_s = 0.002;
    EXPECT_DOUBLE_EQ(at_wall, subModelForce(numbers_.normal, numbers_.across, image, stretch).normal_n);
  }
}

}  // namespace
}  // namespace haptolith
