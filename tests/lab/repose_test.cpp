#include "haptolith/lab/tests/repose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Too small a heap for a good angle, but done in a second or two. On Earth, where soil falls and settles sooner.
constexpr ReposeOptions kSmall{.tube_radius = 6, .fill = 24, .ring_width = 2};

LabConditions conditionsWith(double contact_friction) {
  LabConditions conditions;
  conditions.soil.friction = FrictionModel::kContact;
  conditions.soil.stiffness_n_m = 3000;
  conditions.soil.size_spread = 0.15;
  conditions.soil.contact_friction = contact_friction;
  conditions.gravity_m_s2 = 9.81;
  return conditions;
}

TEST(Repose, OfRubbingParticlesIsThatOfARealHeap) {
  // Over 36 seeds so small a heap has 35.5 +- 0.6 degrees, with a standard deviation of 3; shear's residual angle
  // is 39.
  double mean = 0;
  constexpr int kHeaps = 4;
  ReposeResult heap;
  for (int seed = 1; seed <= kHeaps; ++seed) {
    LabConditions conditions = conditionsWith(0.4);
    conditions.seed = static_cast<std::uint64_t>(seed);
    heap = reposeTest(conditions, kSmall);
    mean += heap.angle_rad / kDegree / kHeaps;
  }
  EXPECT_NEAR(mean, 35.5, 5);
  EXPECT_GT(heap.angle_se_rad, 0);
  EXPECT_GT(heap.height_m, 5 * heap.radius_m);

  // It lies still, the tube is above it, and all of it is there.
  ASSERT_EQ(heap.trace.columns.size(), heap.trace.rows.back().size());
  EXPECT_LT(heap.trace.rows.back()[3], std::sqrt(2 * 9.81 * heap.radius_m / 500));
  EXPECT_GT(heap.trace.rows.back()[1], heap.trace.rows.back()[2]);
  for (const Vec3& centre : heap.centres_m) {
    EXPECT_GT(centre.z(), 0);
  }
}

TEST(Repose, IsSteeperTheMoreParticlesRub) {
  const double smooth = reposeTest(conditionsWith(0.2), kSmall).angle_rad;
  // Not more: of 12 heaps with 0.6 two stand too steep for their slope to be measured.
  const double rough = reposeTest(conditionsWith(0.4), kSmall).angle_rad;
  EXPECT_GT(rough, smooth + 8 * kDegree);
}

TEST(Repose, SaysSoWhenTheSoilRunsToTheWalls) {
  EXPECT_THROW(static_cast<void>(reposeTest(conditionsWith(0), kSmall)), Failure);
}

TEST(Repose, TellsItsProgressWithoutGoingBackAndCanBeInterrupted) {
  LabConditions conditions = conditionsWith(0.4);
  double last = 0;
  conditions.progress = [&](std::string_view what, double share) {
    EXPECT_FALSE(what.empty());
    EXPECT_GE(share, last);
    EXPECT_LE(share, 1);
    last = share;
    return share < 0.3;
  };
  EXPECT_THROW(static_cast<void>(reposeTest(conditions, kSmall)), Failure);
  EXPECT_GE(last, 0.3);
}

TEST(Repose, RefusesNonsense) {
  const LabConditions conditions = conditionsWith(0.4);
  const auto refuses = [](const LabConditions& wrong, const ReposeOptions& options) {
    EXPECT_THROW(static_cast<void>(reposeTest(wrong, options)), InvalidParameter);
  };
  refuses(conditions, {.tube_radius = 1});
  refuses(conditions, {.fill = std::numeric_limits<double>::quiet_NaN()});
  refuses(conditions, {.lift_speed = 0});
  refuses(conditions, {.ring_width = 0});
  LabConditions weightless = conditions;
  weightless.gravity_m_s2 = 0;
  refuses(weightless, kSmall);
  LabConditions no_soil = conditions;
  no_soil.soil.radius_m = -1;
  refuses(no_soil, kSmall);
}

TEST(Repose, IsDrawn) {
  ReposeResult heap;
  heap.radius_m = 1e-3;
  heap.angle_rad = 0.6;
  heap.centres_m = {{0, 0, 1e-3}, {1e-3, 0, 1e-3}};
  heap.profile.rings = {{0, 2e-3}, {2e-3, 1e-3}};
  heap.profile.line = {.intercept = 2e-3, .slope = -0.7};
  const auto path = std::filesystem::temp_directory_path() / "haptolith_repose_test.svg";
  drawRepose(path, heap, "a soil");
  EXPECT_GT(std::filesystem::file_size(path), 1000U);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace haptolith
