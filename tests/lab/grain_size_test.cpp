#include "haptolith/lab/tests/grain_size.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

LabConditions lunar() {
  LabConditions conditions;
  conditions.soil.friction = FrictionModel::kContact;
  conditions.soil.gamma_nm = 6e-5;
  conditions.soil.stiffness_n_m = 3000;
  conditions.soil.size_spread = 0.15;
  conditions.soil.contact_friction = 0.35;
  conditions.soil.contact_cohesion_n = 0.25;
  return conditions;
}

/// A narrow blade: done in seconds.
GrainSizeOptions small() {
  GrainSizeOptions options;
  options.width_m = 0.03;
  options.travel_m = 0.05;
  options.level_m = 0.015;
  options.specimens = 2;
  options.radii_m = {7e-3, 3.5e-3};
  options.graded = false;
  return options;
}

TEST(GrainSize, FinerGrainsAreSmoother) {
  const std::vector<GrainSizeResult> results = grainSizeTest(lunar(), small());
  ASSERT_EQ(results.size(), 2U);
  const GrainSizeResult& coarse = results[0];
  const GrainSizeResult& fine = results[1];
  EXPECT_GT(fine.particles, 6 * coarse.particles);
  EXPECT_GT(coarse.draft_n, 1);
  EXPECT_GT(fine.draft_n, 1);
  EXPECT_LT(fine.variation, 0.8 * coarse.variation);
  for (const GrainSizeResult& result : results) {
    EXPECT_LT(result.variation, 1.02 * result.unfiltered_variation);  // at this speed most of it passes
    EXPECT_GT(result.draft_sd_n, 0);
    // The spectrum contains the variance of the force: a Hann window removes none of the noise.
    double power = 0;
    double before_hz = 0;
    for (const GrainSpectrumPoint& point : result.spectrum) {
      EXPECT_GT(point.frequency_hz, before_hz);
      power += point.power_n2_per_hz * (point.frequency_hz - before_hz);
      before_hz = point.frequency_hz;
    }
    const double expected = std::pow(result.unfiltered_variation * result.draft_n, 2);
    EXPECT_GT(power, 0.2 * expected);
    EXPECT_LT(power, 3 * expected);
  }
}

TEST(GrainSize, AGradedBedIsAsStrongAsItsSoil) {
  GrainSizeOptions options = small();
  options.radii_m = {3.5e-3};
  options.graded = true;
  options.fine_radius_m = 3.5e-3;
  const std::vector<GrainSizeResult> results = grainSizeTest(lunar(), options);
  ASSERT_EQ(results.size(), 2U);
  EXPECT_LT(results[1].particles, results[0].particles);
  EXPECT_NEAR(results[1].draft_n, results[0].draft_n, 0.3 * results[0].draft_n);  // two specimens each
  EXPECT_EQ(results[1].radius_m, 3.5e-3);
}

TEST(GrainSize, RefusesNonsense) {
  const auto refused = [](auto change) {
    GrainSizeOptions options = small();
    change(options);
    EXPECT_THROW((void)grainSizeTest(lunar(), options), InvalidParameter);
  };
  refused([](GrainSizeOptions& o) { o.radii_m = {}; });
  refused([](GrainSizeOptions& o) { o.radii_m = {1e-5}; });
  refused([](GrainSizeOptions& o) { o.travel_m = o.level_m; });
  refused([](GrainSizeOptions& o) { o.speed_m_s = 0; });
  refused([](GrainSizeOptions& o) { o.specimens = 0; });
  refused([](GrainSizeOptions& o) {
    o.graded = true;
    o.fine_radius_m = 2e-3;
  });
}

TEST(GrainSize, DrawsItsForcesAndSpectra) {
  GrainSizeOptions options = small();
  options.radii_m = {7e-3};
  options.specimens = 1;
  const std::vector<GrainSizeResult> results = grainSizeTest(lunar(), options);
  EXPECT_EQ(results[0].draft_sd_n, 0);
  EXPECT_NEAR(results[0].trace.back()[0], options.travel_m, 1e-3);
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "grain.svg";
  std::filesystem::remove(file);
  drawGrainSize(file, results, "grain");
  EXPECT_TRUE(std::filesystem::exists(file));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace haptolith
