#include "haptolith/lab/tests/vertical_cut.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// A decimetre of lunar soil in coarse particles: done in seconds.
constexpr VerticalCutOptions kSmall{.depth = 1.2, .room = 1.5};

LabConditions lunar(double cohesion_n) {
  LabConditions conditions;
  conditions.soil.friction = FrictionModel::kContact;
  conditions.soil.stiffness_n_m = 3000;
  conditions.soil.size_spread = 0.15;
  conditions.soil.contact_friction = 0.35;
  conditions.soil.contact_cohesion_n = cohesion_n;
  return conditions;
}

TEST(VerticalCut, StandsInCohesiveSoil) {
  const VerticalCutResult cut = verticalCutTest(lunar(0.2), kSmall);
  EXPECT_TRUE(cut.stands);
  EXPECT_GT(cut.height_kept, 0.97);
  EXPECT_NEAR(cut.height_before_m, 0.1, 0.015);
  EXPECT_LT(std::abs(cut.crest_back_m), 2 * cut.radius_m);
  EXPECT_LT(cut.toe_ahead_m, 2 * cut.radius_m);
}

TEST(VerticalCut, FallsWithoutCohesion) {
  // From one specimen to the next 0.69 +- 0.07 of the height is left, and the crest goes back by 22 +- 7 mm.
  constexpr int kSpecimens = 4;
  double height_kept = 0;
  double crest_back_m = 0;
  for (int seed = 1; seed <= kSpecimens; ++seed) {
    LabConditions conditions = lunar(0);
    conditions.seed = static_cast<std::uint64_t>(seed);
    const VerticalCutResult cut = verticalCutTest(conditions, kSmall);
    EXPECT_FALSE(cut.stands);
    EXPECT_GT(cut.toe_ahead_m, 4 * cut.radius_m);
    height_kept += cut.height_kept / kSpecimens;
    crest_back_m += cut.crest_back_m / kSpecimens;

    // The soil lies still, behind and in front of the cut, and none is lost.
    EXPECT_LT(cut.trace.rows.back()[3], std::sqrt(2 * 1.625 * cut.radius_m / 500));
    EXPECT_EQ(cut.centres_before_m.size(), cut.centres_after_m.size());
    for (std::size_t i = 0; i < cut.centres_before_m.size(); ++i) {
      EXPECT_LT(cut.centres_before_m[i].x(), 0);  // all behind the plate before
      EXPECT_GT(cut.centres_after_m[i].z(), -2 * cut.radius_m);
    }
  }
  EXPECT_LT(height_kept, 0.8);
  EXPECT_GT(crest_back_m, 2 * lunar(0).soil.radius_m);
}

TEST(CriticalCutHeight, IsWhatOneWorksOutByHand) {
  // 4 * 500 / (1500 * 1.625) * tan(45 + 17.5) = 0.8205 * 1.9210
  EXPECT_NEAR(criticalCutHeight(500, 35 * kDegree, 1500, 1.625), 1.576, 1e-3);
  EXPECT_EQ(criticalCutHeight(0, 35 * kDegree, 1500, 1.625), 0);
  EXPECT_NEAR(criticalCutHeight(500, 0, 1500, 9.81), 4 * 500 / (1500 * 9.81), 1e-12);
}

TEST(CriticalCutHeight, RefusesNonsense) {
  EXPECT_THROW(static_cast<void>(criticalCutHeight(-1, 0.5, 1500, 9.81)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(criticalCutHeight(500, 90 * kDegree, 1500, 9.81)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(criticalCutHeight(500, 0.5, 0, 9.81)), InvalidParameter);
  EXPECT_THROW(static_cast<void>(criticalCutHeight(500, 0.5, 1500, 0)), InvalidParameter);
}

TEST(VerticalCut, RefusesNonsense) {
  const auto refuses = [](const VerticalCutOptions& options) {
    EXPECT_THROW(static_cast<void>(verticalCutTest(lunar(0), options)), InvalidParameter);
  };
  refuses({.height_m = 0.01});  // less than three particles
  refuses({.depth = 0});
  refuses({.room = std::numeric_limits<double>::infinity()});
  refuses({.width = 1});
  refuses({.retreat_speed = -1});
  LabConditions weightless = lunar(0);
  weightless.gravity_m_s2 = 0;
  EXPECT_THROW(static_cast<void>(verticalCutTest(weightless)), InvalidParameter);
}

TEST(VerticalCut, IsDrawn) {
  VerticalCutResult cut;
  cut.radius_m = 7e-3;
  cut.height_before_m = 0.1;
  cut.before = {{-0.05, 0.1}, {-0.01, 0.1}};
  cut.after = {{-0.05, 0.1}, {0.05, 0.02}};
  cut.centres_before_m = {{-0.05, 0, 0.05}, {-0.01, 0, 0.03}};
  cut.centres_after_m = {{-0.05, 0, 0.05}, {0.05, 0, 0.01}};
  const auto path = std::filesystem::temp_directory_path() / "haptolith_cut_test.svg";
  drawVerticalCut(path, cut, "a soil");
  EXPECT_GT(std::filesystem::file_size(path), 1000U);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace haptolith
