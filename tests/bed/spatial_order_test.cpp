#include "haptolith/bed/start/spatial_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "haptolith/bed/contact_lists.h"
#include "haptolith/bed/start/bed_start.h"
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

TEST(SpatialOrder, SlabsHaveEachGroupOnceAndHalfOfThemLieOnOneSide) {
  const BedParameters bed = sandbox(BedStart::kPacked);
  const std::vector<Vec3> points = inSpatialOrder(startingCentres(bed), bed.soil.radius_m);
  std::vector<Float4> spheres;
  for (const Vec3& p : points) {
    spheres.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()), 0});
  }
  const std::vector<std::uint32_t> order = groupsInSlabs(spheres, bed.soil.radius_m);
  std::vector<std::uint32_t> each = order;
  std::ranges::sort(each);
  ASSERT_EQ(each.size(), (points.size() + kGroup - 1) / kGroup);
  for (std::uint32_t group = 0; group < each.size(); ++group) {
    ASSERT_EQ(each[group], group);
  }
  const auto middle_m = [&](std::uint32_t group) { return points[group * kGroup].y(); };
  const std::size_t half = order.size() / 2;
  const double first_m = middle_m(*std::max_element(order.begin(), order.begin() + half,
                                                    [&](auto a, auto b) { return middle_m(a) < middle_m(b); }));
  const double second_m = middle_m(
      *std::min_element(order.begin() + half, order.end(), [&](auto a, auto b) { return middle_m(a) < middle_m(b); }));
  EXPECT_LT(first_m, second_m + 2 * 2 * std::sqrt(3.0) * bed.soil.radius_m) << "two rows of cells, where one is cut";
}

}  // namespace
}  // namespace haptolith
