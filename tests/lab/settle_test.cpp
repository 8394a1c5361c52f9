#include "haptolith/lab/apparatus/settle.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/soil/lunar_density.h"

#include "lab_soils.h"

namespace haptolith {
namespace {

TEST(Settle, LunarSoilHasTheDensityMeasuredOnTheMoon) {
  // Over 8 seeds the uppermost band of one specimen has 1466 kg/m^3 with a standard deviation of 11.
  constexpr int kSpecimens = 3;
  std::vector<double> density_kg_m3(measuredBands().size());
  for (std::uint64_t seed = 1; seed <= kSpecimens; ++seed) {
    const SettleResult result =
        settleTest({.soil = testSoil(0.45, 0), .seed = seed}, {.depth_m = 0.6, .width_diameters = 7});
    ASSERT_EQ(result.bands.size(), measuredBands().size());
    for (std::size_t i = 0; i < result.bands.size(); ++i) {
      density_kg_m3[i] += result.bands[i].density_kg_m3 / kSpecimens;
    }
  }
  for (std::size_t i = 0; i < density_kg_m3.size(); ++i) {
    const MeasuredBand& measured = measuredBands()[i];
    EXPECT_NEAR(density_kg_m3[i], measured.density_kg_m3, measured.tolerance_kg_m3)
        << measured.top_m << " to " << measured.bottom_m;
  }
}

TEST(Settle, DensityGrowsWithDepthAndWithGravity) {
  const SettleOptions options{.depth_m = 0.25, .width_diameters = 8};
  const SettleResult moon = settleTest({.soil = testSoil(0.4, 0)}, options);
  const SettleResult mars = settleTest({.soil = testSoil(0.4, 0), .gravity_m_s2 = 3.721}, options);
  EXPECT_GT(moon.slices[moon.slices.size() - 2].density_kg_m3, moon.slices[1].density_kg_m3 + 50);
  EXPECT_GT(mars.meanDensity(0.1), moon.meanDensity(0.1) + 30);
}

TEST(Settle, RefusesNonsense) {
  const LabConditions conditions{.soil = testSoil(0.4, 0)};
  EXPECT_THROW((void)settleTest(conditions, {.depth_m = 0}), InvalidParameter);
  EXPECT_THROW((void)settleTest(conditions, {.width_diameters = 3}), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
