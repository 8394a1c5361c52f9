#include "haptolith/soil/lunar_density.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

TEST(LunarBulkDensity, IsTheLogarithmicLaw) {
  EXPECT_DOUBLE_EQ(lunarBulkDensity(0), 1270);
  EXPECT_NEAR(lunarBulkDensity(0.01), 1270 + 121 * 0.693147, 1e-3);  // ln 2
  EXPECT_NEAR(lunarBulkDensity(0.6), 1270 + 121 * 4.110874, 1e-3);   // ln 61
}

TEST(LunarBulkDensity, HasTheKnownMeans) {
  EXPECT_NEAR(lunarMeanBulkDensity(0, 0.15), 1507, 0.5);
  EXPECT_NEAR(lunarMeanBulkDensity(0, 0.30), 1578, 0.5);
  EXPECT_NEAR(lunarMeanBulkDensity(0.30, 0.60), 1731, 0.5);
  EXPECT_NEAR(lunarMeanBulkDensity(0, 0.60), 1655, 0.5);
}

TEST(LunarBulkDensity, MeanIsTheIntegralOfTheLaw) {
  constexpr int kSteps = 10000;
  for (const auto& [top, bottom] : {std::pair{0.0, 0.6}, {0.1, 0.11}, {0.0, 0.001}}) {
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      sum += lunarBulkDensity(top + (bottom - top) * (i + 0.5) / kSteps);
    }
    EXPECT_NEAR(lunarMeanBulkDensity(top, bottom), sum / kSteps, 1e-4);
  }
}

TEST(LunarBulkDensity, AgreesWithTheMoon) {
  for (const MeasuredBand& band : measuredBands()) {
    EXPECT_NEAR(lunarMeanBulkDensity(band.top_m, band.bottom_m), band.density_kg_m3, band.tolerance_kg_m3);
  }
}

TEST(LunarBulkDensity, RefusesDepthsThatWereNotMeasured) {
  EXPECT_THROW(static_cast<void>(lunarBulkDensity(-0.001)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(lunarBulkDensity(0.601)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(lunarBulkDensity(std::nan(""))), InvalidParameter);
  EXPECT_THROW(static_cast<void>(lunarMeanBulkDensity(0.2, 0.2)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(lunarMeanBulkDensity(0.3, 0.2)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(lunarMeanBulkDensity(0, 0.7)), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
