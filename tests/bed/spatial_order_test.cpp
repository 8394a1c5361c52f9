#include "haptolith/bed/spatial_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "haptolith/bed/bed_start.h"
#include "haptolith/bed/contact_lists.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

/// Mean of the largest edge of the boxes around each 16 points, in radii.
double meanExtent(const std::vector<Vec3>& points, double radius_m) {
  double sum = 0;
  int groups = 0;
  for (std::size_t first = 0; first + kGroup <= points.size(); first += kGroup) {
    Vec3 low = points[first];
    Vec3 high = low;
    for (std::size_t i = first; i < first + kGroup; ++i) {
      low = low.cwiseMin(points[i]);
      high = high.cwiseMax(points[i]);
    }
    sum += (high - low).maxCoeff() / radius_m;
    ++groups;
  }
  return sum / groups;
}

BedParameters sandbox(BedStart start) {
  BedParameters bed;
  bed.soil = findPreset("P3").soil;
  bed.start = start;
  bed.particles = 8000;
  bed.width_m = bed.length_m = 0.4;
  bed.depth_m = 0.1;
  return bed;
}

TEST(SpatialOrder, MakesLumpsOfSixteenAndLosesNobody) {
  for (const BedStart start : {BedStart::kPacked, BedStart::kRain}) {
    const BedParameters bed = sandbox(start);
    const std::vector<Vec3> points = startingCentres(bed);
    ASSERT_GT(points.size(), 5000U);
    const std::vector<Vec3> ordered = inSpatialOrder(points, bed.soil.radius_m);
    const auto before = [](const Vec3& a, const Vec3& b) {
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    };
    std::vector<Vec3> all = points;
    std::vector<Vec3> found = ordered;
    std::ranges::sort(all, before);
    std::ranges::sort(found, before);
    EXPECT_EQ(all, found);
    const double lines = meanExtent(points, bed.soil.radius_m);
    EXPECT_GT(lines, 20);
    EXPECT_LT(meanExtent(ordered, bed.soil.radius_m), 0.5 * lines) << "no lumps";
  }
}

TEST(SpatialOrder, OfNobodyIsNobodyAndDoesNotDependOnTheOrderBefore) {
  EXPECT_TRUE(inSpatialOrder({}, 0.007).empty());
  const BedParameters bed = sandbox(BedStart::kRain);
  std::vector<Vec3> points = startingCentres(bed);
  const std::vector<Vec3> ordered = inSpatialOrder(points, bed.soil.radius_m);
  std::shuffle(points.begin(), points.end(), std::mt19937_64(4));
  EXPECT_EQ(inSpatialOrder(points, bed.soil.radius_m), ordered);
}

}  // namespace
}  // namespace haptolith
