#include "haptolith/lab/report/findings.h"

#include <gmock/gmock.h>

#include <numbers>
#include <optional>

#include "haptolith/lab/report/specimen_statistics.h"

namespace haptolith {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ResultOf;

constexpr double kEarth_m_s2 = 9.81;
constexpr double kMoon_m_s2 = 1.625;

Verdict verdictOf(const Finding& finding) {
  return verdictOn(finding, finding.number);
}

SettleResult settledTo(double density_kg_m3) {
  SettleResult result;
  result.bands = {{0, 0.15, density_kg_m3}, {0, 0.3, density_kg_m3}};
  return result;
}

SoilTarget target(double density_kg_m3, double angle_deg = 29, double cohesion_pa = 0) {
  return {.bulk_density_kg_m3 = density_kg_m3,
          .friction_angle_deg = angle_deg,
          .friction_angle_range_deg = {},
          .cohesion_pa = cohesion_pa,
          .cohesion_range_pa = {}};
}

TEST(Findings, SandOnEarthIsJudgedByItsOwnDensityAndNotByTheMoons) {
  const auto found = findings(settledTo(1363), kEarth_m_s2, target(1330));
  EXPECT_THAT(found, ElementsAre(AllOf(ResultOf(verdictOf, Verdict::kPass),
                                       Field(&Finding::target, HasSubstr("1330 kg/m³ ± 5 %"))),
                                 AllOf(ResultOf(verdictOf, Verdict::kInfo), Field(&Finding::target, IsEmpty()))));
  EXPECT_EQ(verdictOf(findings(settledTo(1250), kEarth_m_s2, target(1330)).front()), Verdict::kFail);
}

TEST(Findings, CalibrationIsJudgedByWhatWasAsked) {
  SoilTarget asked = target(1500, 42, 520);
  asked.strength = SoilStrength::kPeak;
  const auto good = findings(SoilReached{43.9, 0.5, 623, 40, 1430, 5}, asked);
  EXPECT_THAT(good, Each(ResultOf(verdictOf, Verdict::kPass)));
  EXPECT_EQ(good.front().measured, "peak friction angle");
  const auto bad = findings(SoilReached{39.9, 0.5, 625, 40, 1420, 5}, asked);
  EXPECT_THAT(bad, Each(ResultOf(verdictOf, Verdict::kFail)));
}

TEST(Findings, BladeIsJudgedByWhatPressesOnItsFrontBesideTheEquationThatKnowsItsSidesAndItsHeap) {
  BladeResult blade;
  blade.draft_n = 3;
  blade.front_draft_n = 2.4;
  blade.expected.undisturbed = {.earthmoving = {.draft_n = 1.5}, .upright_wedge = {}, .wedge = {}};
  blade.expected_heaped.undisturbed = {.earthmoving = {.draft_n = 3}, .upright_wedge = {}, .wedge = {}};
  const auto plane = findings(blade, target(1330));
  ASSERT_EQ(plane.size(), 3U);
  EXPECT_DOUBLE_EQ(plane[1].number, 0.8);
  EXPECT_EQ(verdictOf(plane[1]), Verdict::kPass);
  EXPECT_DOUBLE_EQ(plane[2].number, 2);
  EXPECT_EQ(verdictOf(plane[2]), Verdict::kInfo) << "which knows of no heap";

  blade.expected.undisturbed.upright_wedge = {{.draft_n = 2.5}};
  blade.expected.undisturbed.wedge = {{.draft_n = 4}};
  blade.expected_heaped.undisturbed.wedge = {{.draft_n = 4.8}};
  blade.expected.residual = {{.earthmoving = {.draft_n = 1}, .upright_wedge = {{.draft_n = 1.5}}, .wedge = {}}};
  const auto found = findings(blade, target(1330));
  ASSERT_EQ(found.size(), 6U);
  EXPECT_DOUBLE_EQ(found[1].number, 0.5);
  EXPECT_EQ(verdictOf(found[1]), Verdict::kFail);
  EXPECT_THAT(found[1].measured, HasSubstr("crescents"));
  EXPECT_DOUBLE_EQ(found[3].number, 1.2);
  EXPECT_DOUBLE_EQ(found[4].number, 0.75);
  EXPECT_DOUBLE_EQ(found[5].number, 2);
  EXPECT_THAT(found[5].measured, HasSubstr("residual"));
  EXPECT_EQ(verdictOf(found[4]), Verdict::kInfo);
}

TEST(Findings, OfBladesThatSpecimensMetAtOtherDepthsHaveTheSameNames) {
  BladeResult deep;
  deep.width_m = 0.05;
  deep.depth_m = 0.0254;
  BladeResult shallow = deep;
  shallow.depth_m = 0.0243;
  EXPECT_EQ(findings(deep, {}).front().measured, findings(shallow, {}).front().measured);
}

TEST(Findings, LunarSoilOnTheMoonIsJudgedByWhatWasMeasuredThere) {
  for (const std::optional<SoilTarget>& known : {std::optional<SoilTarget>{}, std::optional(target(1500))}) {
    const auto found = findings(settledTo(1520), kMoon_m_s2, known);
    EXPECT_EQ(verdictOf(found.front()), Verdict::kPass);
    EXPECT_THAT(found.front().target, HasSubstr("Lunar Sourcebook"));
    EXPECT_EQ(verdictOf(findings(settledTo(1600), kMoon_m_s2, known).front()), Verdict::kFail);
  }
  EXPECT_FALSE(isLunar(kMoon_m_s2, target(1330)));
  EXPECT_FALSE(isLunar(kEarth_m_s2, {}));
  EXPECT_EQ(verdictOf(findings(settledTo(1520), kEarth_m_s2, {}).front()), Verdict::kInfo);
}

TEST(Findings, StrengthIsJudgedWhereTheTargetSays) {
  ShearResult result;
  result.residual.friction_angle_rad = 30.5 * std::numbers::pi / 180;
  result.peak.friction_angle_rad = 40 * std::numbers::pi / 180;
  result.residual.cohesion_pa = 60;
  SoilTarget wanted = target(1330, 29, 0);
  auto found = findings(result, wanted);
  EXPECT_EQ(verdictOf(found[0]), Verdict::kPass);  // 1.5 degrees off
  EXPECT_EQ(verdictOf(found[1]), Verdict::kFail);  // 60 Pa off
  EXPECT_EQ(verdictOf(found[2]), Verdict::kInfo);
  wanted.strength = SoilStrength::kPeak;
  found = findings(result, wanted);
  EXPECT_EQ(verdictOf(found[0]), Verdict::kInfo);
  EXPECT_EQ(verdictOf(found[2]), Verdict::kFail);  // 11 degrees off
  EXPECT_EQ(verdictOf(findings(result, {})[0]), Verdict::kInfo);
}

TEST(Findings, ACutStandsWithCohesionAndFallsWithout) {
  VerticalCutResult stands;
  stands.height_kept = 0.9;
  EXPECT_EQ(verdictOf(findings(stands, 0.1, target(1500, 42, 520)).front()), Verdict::kPass);
  EXPECT_EQ(verdictOf(findings(stands, 0.1, target(1330, 29, 0)).front()), Verdict::kFail);
  EXPECT_EQ(verdictOf(findings(stands, 0.1, {}).front()), Verdict::kInfo);
}

TEST(Findings, NewtonAndBeverlooHoldForEverySoil) {
  FreeFallResult fall;
  fall.acceleration_ratio = 0.9995;
  EXPECT_EQ(verdictOf(findings(fall).front()), Verdict::kPass);
  fall.acceleration_ratio = 0.998;
  EXPECT_EQ(verdictOf(findings(fall).front()), Verdict::kFail);
  HopperResult hopper;
  hopper.particle_diameter_m = 0.01;
  hopper.fit.exponent = 2.6;
  hopper.points.resize(2);
  hopper.points[0].opening_m = 0.03;
  hopper.points[0].clogged = true;
  hopper.points[1].opening_m = 0.06;
  EXPECT_THAT(findings(hopper), ElementsAre(ResultOf(verdictOf, Verdict::kPass), ResultOf(verdictOf, Verdict::kPass),
                                            ResultOf(verdictOf, Verdict::kPass)));
  hopper.points[0].opening_m = 0.09;
  EXPECT_EQ(verdictOf(findings(hopper)[1]), Verdict::kFail);
  hopper.points[0].clogged = false;
  hopper.points[1].opening_m = 0.02;
  EXPECT_EQ(verdictOf(findings(hopper)[1]), Verdict::kFail);  // clogs nowhere
  EXPECT_EQ(verdictOf(findings(hopper)[2]), Verdict::kFail);  // runs through two diameters
}

}  // namespace
}  // namespace haptolith
