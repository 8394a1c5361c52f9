#include "haptolith/lab/findings.h"

#include <gmock/gmock.h>

#include <numbers>

namespace haptolith {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kEarth_m_s2 = 9.81;
constexpr double kMoon_m_s2 = 1.625;

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
  EXPECT_THAT(found, ElementsAre(AllOf(Field(&Finding::verdict, Verdict::kPass),
                                       Field(&Finding::target, HasSubstr("1330 kg/m³ ± 5 %"))),
                                 AllOf(Field(&Finding::verdict, Verdict::kInfo), Field(&Finding::target, IsEmpty()))));
  EXPECT_EQ(findings(settledTo(1250), kEarth_m_s2, target(1330)).front().verdict, Verdict::kFail);
}

TEST(Findings, LunarSoilOnTheMoonIsJudgedByWhatWasMeasuredThere) {
  for (const std::optional<SoilTarget>& known : {std::optional<SoilTarget>{}, std::optional(target(1500))}) {
    const auto found = findings(settledTo(1520), kMoon_m_s2, known);
    EXPECT_EQ(found.front().verdict, Verdict::kPass);
    EXPECT_THAT(found.front().target, HasSubstr("Lunar Sourcebook"));
    EXPECT_EQ(findings(settledTo(1600), kMoon_m_s2, known).front().verdict, Verdict::kFail);
  }
  EXPECT_FALSE(isLunar(kMoon_m_s2, target(1330)));
  EXPECT_FALSE(isLunar(kEarth_m_s2, {}));
  EXPECT_EQ(findings(settledTo(1520), kEarth_m_s2, {}).front().verdict, Verdict::kInfo);
}

TEST(Findings, StrengthIsJudgedWhereTheTargetSays) {
  ShearResult result;
  result.residual.friction_angle_rad = 30.5 * std::numbers::pi / 180;
  result.peak.friction_angle_rad = 40 * std::numbers::pi / 180;
  result.residual.cohesion_pa = 60;
  SoilTarget wanted = target(1330, 29, 0);
  auto found = findings(result, wanted);
  EXPECT_EQ(found[0].verdict, Verdict::kPass);  // 1.5 degrees off
  EXPECT_EQ(found[1].verdict, Verdict::kFail);  // 60 Pa off
  EXPECT_EQ(found[2].verdict, Verdict::kInfo);
  wanted.strength = SoilStrength::kPeak;
  found = findings(result, wanted);
  EXPECT_EQ(found[0].verdict, Verdict::kInfo);
  EXPECT_EQ(found[2].verdict, Verdict::kFail);  // 11 degrees off
  EXPECT_EQ(findings(result, {})[0].verdict, Verdict::kInfo);
}

TEST(Findings, ACutStandsWithCohesionAndFallsWithout) {
  CutResult stands;
  stands.stands = true;
  EXPECT_EQ(findings(stands, 0.1, target(1500, 42, 520)).front().verdict, Verdict::kPass);
  EXPECT_EQ(findings(stands, 0.1, target(1330, 29, 0)).front().verdict, Verdict::kFail);
  EXPECT_EQ(findings(stands, 0.1, {}).front().verdict, Verdict::kInfo);
}

TEST(Findings, NewtonAndBeverlooHoldForEverySoil) {
  FallResult fall;
  fall.acceleration_ratio = 0.9995;
  EXPECT_EQ(findings(fall).front().verdict, Verdict::kPass);
  fall.acceleration_ratio = 0.998;
  EXPECT_EQ(findings(fall).front().verdict, Verdict::kFail);
  FunnelResult funnel;
  funnel.particle_diameter_m = 0.01;
  funnel.fit.exponent = 2.6;
  funnel.points.resize(2);
  funnel.points[0].opening_m = 0.03;
  funnel.points[0].clogged = true;
  funnel.points[1].opening_m = 0.06;
  EXPECT_THAT(findings(funnel),
              ElementsAre(Field(&Finding::verdict, Verdict::kPass), Field(&Finding::verdict, Verdict::kPass)));
  funnel.points[0].opening_m = 0.09;
  EXPECT_EQ(findings(funnel).back().verdict, Verdict::kFail);
}

}  // namespace
}  // namespace haptolith
