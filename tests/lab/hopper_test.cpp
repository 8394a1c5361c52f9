#include "haptolith/lab/tests/hopper.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

/// On Earth, where soil falls and settles sooner.
LabConditions rubbing() {
  LabConditions conditions;
  conditions.soil.friction = FrictionModel::kContact;
  conditions.soil.stiffness_n_m = 3000;
  conditions.soil.size_spread = 0.15;
  conditions.soil.contact_friction = 0.4;
  conditions.gravity_m_s2 = 9.81;
  return conditions;
}

TEST(Hopper, RunsThroughAWideOpeningAndClogsOverANarrowOne) {
  const HopperResult hopper = hopperTest(rubbing(), {.openings = {2, 10}, .fill = 8, .fill_openings = 0, .margin = 3});
  ASSERT_EQ(hopper.points.size(), 2U);
  const HopperPoint& narrow = hopper.points[0];
  EXPECT_TRUE(narrow.clogged);
  ASSERT_EQ(hopper.clogged_m.size(), 1U);
  EXPECT_EQ(hopper.clogged_m[0], narrow.opening_m);

  const HopperPoint& wide = hopper.points[1];
  EXPECT_FALSE(wide.clogged);
  EXPECT_NEAR(wide.opening_m, 10 * 14e-3, 1e-12);
  // Half to once Beverloo's rate for round grains: particles that do not roll are slower.
  const double beverloo = beverlooRate(
      {.opening_m = wide.opening_m, .particle_diameter_m = hopper.particle_diameter_m, .density_kg_m3 = 1400});
  EXPECT_GT(wide.rate_kg_s, 0.2 * beverloo);
  EXPECT_LT(wide.rate_kg_s, 1.2 * beverloo);

  // Mass only ever runs out, and never faster than it could fall.
  double last = 0;
  for (const std::vector<double>& row : wide.trace.rows) {
    EXPECT_GE(row[1], last);
    last = row[1];
  }
  EXPECT_EQ(last, wide.discharged_kg);
  EXPECT_EQ(hopper.fit.exponent, 0);  // one opening makes no law
}

TEST(Hopper, RunsWithoutFrictionThroughWhatClogsWithIt) {
  LabConditions slippery = rubbing();
  slippery.soil.contact_friction = 0;
  const HopperResult hopper = hopperTest(slippery, {.openings = {4}, .fill = 6, .fill_openings = 0, .margin = 3});
  EXPECT_FALSE(hopper.points[0].clogged);
  EXPECT_GT(hopper.points[0].rate_kg_s, 0);
}

TEST(Hopper, RefusesNonsense) {
  const auto refuses = [](const HopperOptions& options) {
    EXPECT_THROW(static_cast<void>(hopperTest(rubbing(), options)), InvalidParameter);
  };
  refuses({.openings = {}});
  refuses({.openings = {0.5}});
  refuses({.openings = {8, std::numeric_limits<double>::quiet_NaN()}});
  refuses({.fill = 1});
  refuses({.margin = 0});
  refuses({.smallest_fitted = 1});
  LabConditions weightless = rubbing();
  weightless.gravity_m_s2 = 0;
  EXPECT_THROW(static_cast<void>(hopperTest(weightless)), InvalidParameter);
}

TEST(Hopper, IsDrawn) {
  HopperResult hopper;
  hopper.particle_diameter_m = 2e-3;
  hopper.widest_m = 20e-3;
  hopper.points.resize(2);
  hopper.points[0].opening_m = 4e-3;
  hopper.points[0].clogged = true;
  hopper.points[1].opening_m = 20e-3;
  hopper.points[1].rate_kg_s = 0.1;
  hopper.fit = {.prefactor = 1000, .exponent = 2.5, .exponent_se = 0.1, .gap = kBeverlooGap, .log_residual = 0};
  const auto path = std::filesystem::temp_directory_path() / "haptolith_hopper_test.svg";
  drawHopper(path, hopper, "a soil");
  EXPECT_GT(std::filesystem::file_size(path), 1000U);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace haptolith
