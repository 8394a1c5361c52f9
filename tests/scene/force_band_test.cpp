#include "haptolith/scene/force_band.h"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "haptolith/scene/scene.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;

TEST(RecentForce, IsTheMeanMagnitudeOfAQuarterOfASecond) {
  RecentForce mean(kTick_s);
  for (int tick = 0; tick < 249; ++tick) {
    mean.add({100, 5});
    EXPECT_FALSE(mean.mean()) << tick;
  }
  mean.add({100, 5});
  ASSERT_TRUE(mean.mean());
  EXPECT_DOUBLE_EQ(mean.mean()->force_n, 100);
  EXPECT_DOUBLE_EQ(mean.mean()->contacts, 5);
  for (int tick = 0; tick < 250; ++tick) {
    mean.add({tick % 2 == 0 ? 5.0 : 3.0, 1});
  }
  EXPECT_DOUBLE_EQ(mean.mean()->force_n, 4) << "older ticks are forgotten";
  mean.restart();
  EXPECT_FALSE(mean.mean());
}

TEST(RecentForce, IsNeverFarFromTheExactMean) {
  RecentForce mean(kTick_s);
  std::vector<double> forces_n;
  for (int tick = 0; tick < 3000; ++tick) {
    forces_n.push_back(5 + 3 * std::sin(0.01 * tick) + (tick % 7));
    mean.add({forces_n.back(), 0});
    if (tick < 249) {
      continue;
    }
    double sum_n = 0;
    for (std::size_t i = forces_n.size() - 250; i < forces_n.size(); ++i) {
      sum_n += forces_n[i];
    }
    EXPECT_NEAR(mean.mean()->force_n, sum_n / 250, 0.2) << tick;  // the window is shorter by up to 9 ticks
  }
}

SoilParameters frictionalSoil() {
  SoilParameters soil;
  soil.friction = FrictionModel::kContact;
  return soil;
}

TEST(ForceRange, HoldsTheForceAndIsRelativelyNarrowerForLargeForces) {
  const SoilParameters soil = frictionalSoil();
  double before = 1e9;
  for (const double force_n : {0.1, 1.0, 10.0, 100.0, 1000.0}) {
    const auto range = forceRange({force_n, 40 * force_n}, soil, 1.62);
    ASSERT_TRUE(range);
    EXPECT_LT(range->low_n, force_n);
    EXPECT_GT(range->high_n, force_n);
    EXPECT_GE(range->low_n, 0);
    const double width = (range->high_n - range->low_n) / force_n;
    EXPECT_LT(width, before);
    before = width;
  }
}

// Soil of twice the length, with forces of eight times, has eight times the range.
TEST(ForceRange, HasNoScaleOfItsOwn) {
  SoilParameters soil = frictionalSoil();
  soil.contact_cohesion_n = 1e-3;
  const ForceRange range = *forceRange({2, 3}, soil, 9.81);
  soil.radius_m *= 2;
  soil.stiffness_n_m *= 2;
  soil.contact_cohesion_n *= 8;
  const ForceRange scaled = *forceRange({16, 3}, soil, 9.81);
  EXPECT_NEAR(scaled.low_n, 8 * range.low_n, 1e-9);
  EXPECT_NEAR(scaled.high_n, 8 * range.high_n, 1e-9);
}

// Found in four sands whose contacts are eight times as stiff as those of lunar soil.
TEST(ForceRange, IsFourTimesAsWideInStiffSand) {
  SoilParameters soil = frictionalSoil();
  soil.stiffness_n_m = 3000 * soil.radius_m / 7e-3;
  const ForceRange lunar = *forceRange({100, 400}, soil, 9.81);
  soil.stiffness_n_m *= 8;
  const ForceRange stiff = *forceRange({100, 400}, soil, 9.81);
  EXPECT_NEAR(stiff.high_n - (lunar.low_n + lunar.high_n) / 2, 4 * (lunar.high_n - lunar.low_n) / 2, 1e-9);
}

TEST(ForceRange, IsNotKnownWithIcra2021Friction) {
  SoilParameters soil = frictionalSoil();
  soil.friction = FrictionModel::kIcra2021;
  EXPECT_FALSE(forceRange({1, 3}, soil, 1.62));
}

TEST(ForceRange, OfASceneIsKnownAfterAQuarterOfASecond) {
  BedParameters bed;
  bed.soil.friction = FrictionModel::kContact;
  Scene scene(bed, ToolParameters{});
  const double surface_m = scene.bed().surfaceHeight();
  const auto down = [&](int tick) { return HandState{{Pose{Vec3(0, 0, surface_m + 0.01 - 1e-4 * tick)}, {}}, 1}; };
  scene.placeTool(down(0));
  for (int tick = 1; tick <= 250; ++tick) {
    EXPECT_FALSE(scene.forceBand());
    ASSERT_EQ(scene.tick(down(tick)), StepStatus::kOk);
  }
  ASSERT_TRUE(scene.forceBand());
  EXPECT_GT(scene.forceBand()->high_n, 0.1) << "the tool is 15 mm deep";
  const SavedScene saved = scene.save();
  scene.restore(saved);
  EXPECT_FALSE(scene.forceBand()) << "the ticks before are not known";
}

}  // namespace
}  // namespace haptolith
