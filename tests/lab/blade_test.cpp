#include "haptolith/lab/tests/blade.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/lab/theory/earthmoving.h"
#include "haptolith/lab/theory/wedge.h"

#include "small_soil.h"

namespace haptolith {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kRadius_m = 4e-3;

/// The equation's plane case: as wide as its box.
const BladeOptions kPlane{.width_m = 0.05,
                          .depth_m = 0.025,
                          .speed_m_s = 0.06,
                          .side_room_depths = 0,
                          .friction_angle_rad = 48 * kDegree};  // the peak of direct shear

TEST(Blade, NeedsADraftOfTheEarthmovingEquationsSize) {
  const BladeResult blade = bladeTest(coarseSand(kRadius_m), kPlane);
  EXPECT_NEAR(blade.depth_m, 0.025, 0.004);
  EXPECT_GT(blade.draft_n, 0.6 * blade.expected.undisturbed.earthmoving.draft_n);
  EXPECT_LT(blade.draft_n, 2.2 * blade.expected.undisturbed.earthmoving.draft_n);
  EXPECT_LT(blade.vertical_n, 0);  // it is lifted by the soil that climbs it
  EXPECT_GT(blade.draft_se_n, 0);
  EXPECT_LT(blade.draft_se_n, 0.3 * blade.draft_n);
  EXPECT_LT(blade.inertia, 0.02);
}

TEST(Blade, IsComparedWithTheEquationForTheBedItReallyMovedThrough) {
  const BladeResult blade = bladeTest(coarseSand(kRadius_m), kPlane);
  const BladeForce force = earthmovingForce({.width_m = 0.05,
                                             .depth_m = blade.depth_m,
                                             .rake_rad = std::numbers::pi / 2,
                                             .density_kg_m3 = blade.bulk_density_kg_m3,
                                             .gravity_m_s2 = 9.807,
                                             .friction_angle_rad = 48 * kDegree,
                                             .tool_friction_rad = std::atan(0.36)});
  EXPECT_DOUBLE_EQ(blade.expected.undisturbed.earthmoving.draft_n, force.draft_n);
  EXPECT_DOUBLE_EQ(blade.expected.undisturbed.earthmoving.vertical_n, force.vertical_n);
}

TEST(Blade, GoesLessDeepBelowTheSurfaceThanBelowTheTipsOfGrains) {
  BladeOptions options = kPlane;
  const BladeResult from_tips = bladeTest(coarseSand(kRadius_m), options);
  options.depth_from = DepthFrom::kSurface;
  const BladeResult from_surface = bladeTest(coarseSand(kRadius_m), options);
  EXPECT_EQ(from_surface.draft_n, from_tips.draft_n);  // the blade goes where it went
  EXPECT_LT(from_surface.depth_m, from_tips.depth_m - 0.4 * kRadius_m);
  EXPECT_GT(from_surface.depth_m, from_tips.depth_m - 2 * kRadius_m);
  EXPECT_LT(from_surface.expected.undisturbed.earthmoving.draft_n, from_tips.expected.undisturbed.earthmoving.draft_n);
}

TEST(Blade, IsComparedWithWedgesThatKnowItsSidesWhereItHasSides) {
  LabConditions conditions = coarseSand(kRadius_m);
  EXPECT_FALSE(bladeTest(conditions, kPlane).expected.undisturbed.wedge);
  EXPECT_FALSE(bladeTest(conditions, kPlane).expected.undisturbed.upright_wedge);

  BladeOptions narrow = kPlane;
  narrow.side_room_depths = 1;
  narrow.residual = MohrCoulomb{.friction_angle_rad = 39 * kDegree};
  const BladeResult blade = bladeTest(conditions, narrow);
  BladeCase expected{.width_m = 0.05,
                     .depth_m = blade.depth_m,
                     .rake_rad = std::numbers::pi / 2,
                     .density_kg_m3 = blade.bulk_density_kg_m3,
                     .gravity_m_s2 = 9.807,
                     .friction_angle_rad = 48 * kDegree,
                     .tool_friction_rad = std::atan(0.36)};
  ASSERT_TRUE(blade.expected.undisturbed.wedge && blade.expected.undisturbed.upright_wedge && blade.expected.residual);
  EXPECT_DOUBLE_EQ(blade.expected.undisturbed.wedge->draft_n, wedgeForce(expected).draft_n);
  EXPECT_DOUBLE_EQ(blade.expected.undisturbed.upright_wedge->draft_n, uprightWedgeForce(expected).draft_n);
  EXPECT_GT(blade.heap_beside_pa, 0);
  EXPECT_LT(blade.heap_beside_pa, 0.7 * blade.heap_pa) << "soil heaps up before the blade";
  BladeCase heaped = expected;
  heaped.surcharge_pa = blade.heap_pa;
  heaped.surcharge_beside_pa = blade.heap_beside_pa;
  EXPECT_DOUBLE_EQ(blade.expected_heaped.undisturbed.wedge->draft_n, wedgeForce(heaped).draft_n);
  expected.friction_angle_rad = 39 * kDegree;
  EXPECT_DOUBLE_EQ(blade.expected.residual->earthmoving.draft_n, earthmovingForce(expected).draft_n);
  EXPECT_DOUBLE_EQ(blade.expected.residual->wedge->draft_n, wedgeForce(expected).draft_n);
}

TEST(Blade, HasBeforeItTheWeightOfWhatItWentThrough) {
  // Nothing escapes to the sides, so the pile's mean over 0.5 to 1.5 depths is the soil cut in one depth of travel.
  for (const double rake_deg : {60.0, 90.0}) {
    BladeOptions options = kPlane;
    options.depth_from = DepthFrom::kSurface;
    options.rake_rad = rake_deg * kDegree;
    const BladeResult blade = bladeTest(coarseSand(kRadius_m), options);
    BladeCase expected{.width_m = blade.width_m,
                       .depth_m = blade.depth_m,
                       .rake_rad = options.rake_rad,
                       .density_kg_m3 = blade.bulk_density_kg_m3,
                       .gravity_m_s2 = 9.807,
                       .friction_angle_rad = options.friction_angle_rad,
                       .tool_friction_rad = std::atan(options.tool_friction)};
    const double beta = earthmovingForce(expected).beta_rad;
    const double reach_m = blade.depth_m * (1 / std::tan(options.rake_rad) + 1 / std::tan(beta));
    const double swept_m = blade.depth_m + kRadius_m;  // the edge takes along the grains that it meets
    const double swept_pa = blade.bulk_density_kg_m3 * 9.807 * swept_m * options.depth_m / reach_m;
    EXPECT_NEAR(blade.heap_pa / swept_pa, 0.95, 0.2) << rake_deg;

    expected.surcharge_pa = blade.heap_pa;
    const double heaped_n = earthmovingForce(expected).draft_n;
    EXPECT_NEAR(blade.expected_heaped.undisturbed.earthmoving.draft_n, heaped_n, 1e-9 * heaped_n);
    EXPECT_GT(heaped_n, 1.3 * blade.expected.undisturbed.earthmoving.draft_n);
  }
}

TEST(Blade, ThatLeansForwardIsMeasuredAllTheSame) {
  BladeOptions forward = kPlane;
  forward.side_room_depths = 1;
  forward.rake_rad = 100 * kDegree;
  forward.friction_angle_rad = 39 * kDegree;
  const BladeResult blade = bladeTest(coarseSand(kRadius_m), forward);
  EXPECT_GT(blade.draft_n, 0);
  EXPECT_FALSE(blade.expected.undisturbed.wedge);
  EXPECT_TRUE(blade.expected.undisturbed.upright_wedge);
}

TEST(Blade, TellsWhatPressesOnItsFrontFromWhatItsEdgeMeets) {
  BladeOptions flat = kPlane;
  flat.rake_rad = 45 * kDegree;
  const BladeResult upright = bladeTest(coarseSand(kRadius_m), kPlane);
  const BladeResult leaning = bladeTest(coarseSand(kRadius_m), flat);
  EXPECT_GT(upright.front_draft_n, 0.75 * upright.draft_n);
  EXPECT_LT(upright.front_draft_n, 1.02 * upright.draft_n);
  EXPECT_LT(leaning.front_draft_n, 0.75 * leaning.draft_n) << "its edge presses soil down and forward";
  // The force of soil sliding up the front deviates from its normal by at most the friction angle: Coulomb.
  const auto angle_to_path = [](const BladeResult& b) { return std::atan2(b.front_vertical_n, b.front_draft_n); };
  const double friction = std::atan(0.36);
  EXPECT_NEAR(angle_to_path(upright), -friction, 5 * kDegree);
  EXPECT_NEAR(angle_to_path(leaning), 45 * kDegree - friction, 5 * kDegree);
}

TEST(Blade, LeaningBackIsEasierToDrawAndLiftedLess) {
  BladeOptions flat = kPlane;
  flat.rake_rad = 45 * kDegree;
  const BladeResult upright = bladeTest(coarseSand(kRadius_m), kPlane);
  const BladeResult leaning = bladeTest(coarseSand(kRadius_m), flat);
  EXPECT_LT(leaning.draft_n, upright.draft_n);
  EXPECT_GT(leaning.vertical_n, upright.vertical_n);
}

TEST(Blade, NeedsADraftInProportionToGravityWhenContactsAreAsMuchSofter) {
  // That soil in other units of time: only the settling of the bed differs. With contacts as stiff on both
  // bodies the ratio is less, for soil that is pressed together less dilates more.
  constexpr double kWeaker = 9.807 / 1.625;
  LabConditions conditions = coarseSand(kRadius_m);
  const double earth = bladeTest(conditions, kPlane).draft_n;
  BladeOptions slower = kPlane;
  *slower.speed_m_s /= std::sqrt(kWeaker);  // equal v^2/(g d)
  conditions.gravity_m_s2 /= kWeaker;
  conditions.soil.stiffness_n_m /= kWeaker;
  conditions.soil.gamma_nm /= kWeaker;
  EXPECT_NEAR(earth / bladeTest(conditions, slower).draft_n / kWeaker, 1, 0.35);
}

TEST(Blade, IsHarderToDrawThroughCohesiveSoil) {
  LabConditions conditions = coarseSand(kRadius_m);
  const double dry = bladeTest(conditions, kPlane).draft_n;
  conditions.soil.contact_cohesion_n = 0.3;
  BladeOptions options = kPlane;
  options.cohesion_pa = 2500;
  const BladeResult sticky = bladeTest(conditions, options);
  EXPECT_GT(sticky.draft_n, 1.3 * dry);
  EXPECT_GT(sticky.expected.undisturbed.earthmoving.draft_n, 1.3 * dry);
}

TEST(Blade, TestRefusesNonsense) {
  const std::vector<std::function<void(BladeOptions&)>> nonsense = {
      [](BladeOptions& blade) { blade.width_m = 0; },
      [](BladeOptions& blade) { blade.depth_m = 0.01; },  // under 2 particles
      [](BladeOptions& blade) { blade.rake_rad = 90; },   // degrees
      [](BladeOptions& blade) { blade.speed_m_s = 1; },   // inertia counts
      [](BladeOptions& blade) { blade.speed_m_s = 0; },
      [](BladeOptions& blade) { blade.tool_friction = 3; },
      [](BladeOptions& blade) { blade.level_depths = 2; },  // after the end
      [](BladeOptions& blade) { blade.travel_depths = std::numeric_limits<double>::infinity(); },
      [](BladeOptions& blade) { blade.side_room_depths = -1; },
      [](BladeOptions& blade) { blade.ahead_depths = 0; },
      [](BladeOptions& blade) { blade.below_depths = 0; },
      [](BladeOptions& blade) { blade.friction_angle_rad = 39; },  // degrees
      [](BladeOptions& blade) { blade.cohesion_pa = std::nan(""); },
      [](BladeOptions& blade) { blade.residual = MohrCoulomb{.friction_angle_rad = 39}; },
      [](BladeOptions& blade) { blade.residual = MohrCoulomb{.cohesion_pa = -1}; },
  };
  for (std::size_t i = 0; i < nonsense.size(); ++i) {
    BladeOptions options = kPlane;
    nonsense[i](options);
    EXPECT_THROW(static_cast<void>(bladeTest(coarseSand(kRadius_m), options)), InvalidParameter) << i;
  }
}

TEST(Blade, IsDrawnBesideTheEquation) {
  BladeResult blade;
  blade.trace = {.columns = {"travel_m", "draft_n", "vertical_n"}, .rows = {{0, 0, 0}, {0.01, 2, -1}, {0.02, 2.2, -1}}};
  blade.draft_n = 2.1;
  blade.expected.undisturbed.earthmoving.draft_n = 1.9;
  blade.expected.undisturbed.wedge = WedgeForce{.draft_n = 2.5};
  const auto file = std::filesystem::path(testing::TempDir()) / "blade.svg";
  std::filesystem::remove(file);  // left by an earlier run
  drawBlade(file, blade, "a soil");
  std::ifstream stream(file);
  const std::string svg{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_NE(svg.find("earthmoving equation"), std::string::npos);
  EXPECT_NE(svg.find("with crescents"), std::string::npos);
}

}  // namespace
}  // namespace haptolith
