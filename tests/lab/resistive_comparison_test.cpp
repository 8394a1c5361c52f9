#include "haptolith/lab/tests/resistive_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "haptolith/core/error.h"

#include "small_soil.h"

namespace haptolith {
namespace {

constexpr double kRadius_m = 6e-3;

const ResistiveOptions kSmall{.diameter_m = 0.048,
                              .max_sinkage_m = 0.018,
                              .push_speed_m_s = 0.06,
                              .blade_width_m = 0.04,
                              .blade_depth_m = 0.024,
                              .blade_speed_m_s = 0.06,
                              .scaling = false,
                              .shear = {.normal_stresses_pa = {200, 400, 800},
                                        .width_diameters = 8,
                                        .length_diameters = 6,
                                        .height_diameters = 6,
                                        .strain = 2.5,
                                        .residual_from = 1.5}};

TEST(ResistiveComparison, FindsOurBedAndTheTheoryOfTheSameOrderWithNothingTuned) {
  const ResistiveResult result = resistiveComparison(coarseSand(kRadius_m), kSmall);
  ASSERT_EQ(result.pushes.size(), 4U);
  EXPECT_TRUE(result.scalings.empty());
  EXPECT_EQ(result.trace.rows.size(), result.pushes.front().curve.size());
  for (const ResistivePush& push : result.pushes) {
    EXPECT_GT(push.theory_n, 0) << push.name;
    EXPECT_GT(push.bed_n, 0.2 * push.theory_n) << push.name;
    EXPECT_LT(push.bed_n, 5 * push.theory_n) << push.name;
  }
  EXPECT_GT(result.draft_n, 0.2 * result.theory_draft_n);
  EXPECT_LT(result.draft_n, 5 * result.theory_draft_n);
  EXPECT_NEAR(result.xi_n_m3, resistiveScale(result.soil), 1e-6);
  EXPECT_GT(result.soil.internal_friction, 0.3);  // contact friction of 0.4, particles that do not turn
  EXPECT_LT(result.soil.internal_friction, 1.1);
}

TEST(ResistiveComparison, TakesAFrictionAngleInsteadOfMeasuringIt) {
  ResistiveOptions options = kSmall;
  options.friction_angle_rad = std::atan(0.5);
  LabConditions conditions = coarseSand(kRadius_m);
  conditions.soil.contact_cohesion_n = 1;  // taken away
  const ResistiveResult result = resistiveComparison(conditions, options);
  EXPECT_NEAR(result.soil.internal_friction, 0.5, 1e-12);
}

TEST(ResistiveComparison, RefusesNonsense) {
  ResistiveOptions options = kSmall;
  options.diameter_m = 7 * kRadius_m;
  EXPECT_THROW(static_cast<void>(resistiveComparison(coarseSand(kRadius_m), options)), InvalidParameter);
  options = kSmall;
  options.max_sinkage_m = options.diameter_m;
  EXPECT_THROW(static_cast<void>(resistiveComparison(coarseSand(kRadius_m), options)), InvalidParameter);
  options = kSmall;
  options.size_factor = 1;
  EXPECT_THROW(static_cast<void>(resistiveComparison(coarseSand(kRadius_m), options)), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
