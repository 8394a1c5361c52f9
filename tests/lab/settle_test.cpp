#include "haptolith/lab/settle.h"

#include <gtest/gtest.h>

#include "haptolith/core/error.h"
#include "haptolith/soil/lunar_density.h"

#include "lab_soils.h"

namespace haptolith {
namespace {

TEST(Settle, LunarSoilHasTheDensityMeasuredOnTheMoon) {
  const SettleResult result = settleTest({.soil = testSoil(0.45, 0)}, {.depth_m = 0.6, .width_diameters = 7});
  ASSERT_EQ(result.bands.size(), measuredBands().size());
  for (std::size_t i = 0; i < result.bands.size(); ++i) {
    const MeasuredBand& measured = measuredBands()[i];
    EXPECT_NEAR(result.bands[i].density_kg_m3, measured.density_kg_m3, measured.tolerance_kg_m3)
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
