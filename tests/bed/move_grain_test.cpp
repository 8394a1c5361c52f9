// A particle that is moved while the bed runs.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/critical_step.h"

namespace haptolith {
namespace {

BedParameters settled(int threads = 1) {
  BedParameters bed;
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.contact_friction = 0.5;
  bed.soil.contact_cohesion_n = 0.01;
  bed.soil.size_spread = 0.15;
  bed.soil.stiffness_n_m = 1000;
  bed.width_m = bed.length_m = 0.24;
  bed.depth_m = 0.05;
  bed.start = BedStart::kSettled;
  bed.sleep_speed_m_s = 1e-3;
  bed.threads = threads;
  return bed;
}

Vec3 placeOf(const Bed& bed, std::size_t grain) {
  const Float4& at = bed.state().position[grain];
  return {at.x, at.y, at.z};
}

/// The free grains from the highest down.
std::vector<std::size_t> highest(const Bed& bed) {
  std::vector<std::size_t> grains;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    if (!bed.isDriven(i)) {
      grains.push_back(i);
    }
  }
  std::ranges::sort(grains, std::ranges::greater(), [&](std::size_t i) { return bed.state().position[i].z; });
  return grains;
}

/// A place a fifth of a particle's radius above the soil, next to the centre.
GrainMove someMove(const Bed& bed, std::size_t which, double x_m) {
  const std::size_t grain = highest(bed)[which];
  return {grain, placeOf(bed, grain), {x_m, 0.02 * static_cast<double>(which), bed.surfaceHeight() + 8e-3}};
}

void run(Bed& bed, int ticks) {
  const int substeps = substepsFor(bed.parameters().soil, 0, 1e-3, 32);
  for (int i = 0; i < ticks * substeps; ++i) {
    ASSERT_EQ(bed.step(1e-3 / substeps), StepStatus::kOk);
  }
}

TEST(MoveGrain, ItFallsOntoTheSoilAndLiesThere) {
  Bed bed(settled());
  run(bed, 300);
  ASSERT_EQ(bed.awake(), 0U);
  const GrainMove move = someMove(bed, 0, 0.05);
  ASSERT_TRUE(bed.moveGrain(move));
  EXPECT_LT((placeOf(bed, move.grain) - move.to_m).norm(), 1e-7);
  run(bed, 1);
  EXPECT_GT(bed.awake(), 0U) << "what it lay on is not held down any more";
  double energy_j = bed.energy();
  for (int look = 0; look < 40; ++look) {
    run(bed, 25);
    EXPECT_LT(bed.energy(), energy_j + 1e-9);
    energy_j = bed.energy();
  }
  EXPECT_EQ(bed.awake(), 0U);
  const Vec3 lies_m = placeOf(bed, move.grain);
  EXPECT_LT(lies_m.z(), move.to_m.z() - 1e-3);
  double nearest_m = 1;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    nearest_m = i == move.grain ? nearest_m : std::min(nearest_m, (placeOf(bed, i) - lies_m).norm());
  }
  EXPECT_NEAR(nearest_m, 2 * bed.parameters().soil.radius_m, 0.2 * bed.parameters().soil.radius_m) << "on others";
}

TEST(MoveGrain, IsTheSameForAnyNumberOfThreadsAndFromASavedBed) {
  std::vector<std::uint64_t> expected;
  for (const int threads : {1, 2, 3}) {
    Bed bed(settled(threads));
    std::vector<std::uint64_t> hashes;
    for (std::size_t i = 0; i < 6; ++i) {
      ASSERT_TRUE(bed.moveGrain(someMove(bed, i, -0.05)));
      if (i == 4 && threads > 1) {
        const SavedBed saved = bed.save();
        ASSERT_TRUE(bed.moveGrain(someMove(bed, 0, 0.05)));
        run(bed, 10);
        bed.restore(saved);
      }
      run(bed, 60);
      hashes.push_back(bed.hash());
    }
    expected = expected.empty() ? hashes : expected;
    EXPECT_EQ(hashes, expected) << threads;
  }
}

TEST(MoveGrain, IsRefusedWhereAnythingIsNotAsItWasSeen) {
  Bed bed(settled());
  const std::uint64_t before = bed.hash();
  const GrainMove good = someMove(bed, 0, 0.05);
  const auto refuses = [&](std::size_t grain, const Vec3& from_m, const Vec3& to_m) {
    return !bed.moveGrain({grain, from_m, to_m}) && bed.hash() == before;
  };
  const double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refuses(good.grain, good.from_m + Vec3(1e-3, 0, 0), good.to_m)) << "it has gone on";
  EXPECT_TRUE(refuses(good.grain, {kNan, 0, 0}, good.to_m));
  EXPECT_TRUE(refuses(bed.particles(), good.from_m, good.to_m));
  EXPECT_TRUE(refuses(std::numeric_limits<std::size_t>::max(), good.from_m, good.to_m));
  for (const double somewhere : {kNan, 1e300, -1e300, std::numeric_limits<double>::infinity()}) {
    EXPECT_TRUE(refuses(good.grain, good.from_m, {somewhere, 0, good.to_m.z()})) << somewhere;
    EXPECT_TRUE(refuses(good.grain, good.from_m, {0, somewhere, good.to_m.z()})) << somewhere;
    EXPECT_TRUE(refuses(good.grain, good.from_m, {0, 0, somewhere})) << somewhere;
  }
  EXPECT_TRUE(refuses(good.grain, good.from_m, {good.to_m.x(), 0, 0.001})) << "in the floor";
  EXPECT_TRUE(refuses(good.grain, good.from_m, {good.to_m.x(), 0, 0.03})) << "among others";
  const std::size_t last = bed.particles() - 1;
  ASSERT_TRUE(bed.isDriven(last)) << "held where the box ends";
  EXPECT_TRUE(refuses(last, placeOf(bed, last), good.to_m));
  EXPECT_TRUE(bed.moveGrain(good));
  EXPECT_NE(bed.hash(), before);
}

}  // namespace
}  // namespace haptolith
