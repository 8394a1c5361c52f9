#include "haptolith/lab/report/validation.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

Claim within(double share) {
  Claim claim{
      .id = "weight", .group = "Newton", .claim = "Weight felt", .reference = "Newton", .unit = "N", .note = ""};
  claim.expected = 10;
  claim.within = share;
  return claim;
}

std::vector<ClaimSpecimen> specimens(const std::vector<double>& ours) {
  std::vector<ClaimSpecimen> all;
  all.reserve(ours.size());
  for (const double number : ours) {
    all.push_back({.ours = number, .other = {}, .why_not = ""});
  }
  return all;
}

TEST(Validation, HoldsIfTheIntervalOfTheMeanIsInsideTheTolerance) {
  const ClaimOutcome outcome = judge(within(0.1), specimens({9.7, 10, 10.3}));
  EXPECT_EQ(outcome.light, ClaimLight::kGreen);
  EXPECT_EQ(outcome.specimens, 3U);
  EXPECT_DOUBLE_EQ(outcome.ours->mean, 10);
  EXPECT_NEAR(*outcome.ours->standard_error, 0.3 / std::sqrt(3), 1e-12);
  EXPECT_DOUBLE_EQ(outcome.ratio->mean, 1);
  EXPECT_NEAR(outcome.spread, 0.03, 1e-12);
  EXPECT_DOUBLE_EQ(outcome.ratio_range->lowest, 0.9);
  EXPECT_DOUBLE_EQ(outcome.ratio_range->highest, 1.1);
  // Student's t of 2 degrees of freedom, 95 %: 2.920 (published tables).
  EXPECT_NEAR(outcome.ratio_interval->lowest, 1 - 2.920 * 0.03 / std::sqrt(3), 1e-5);
  EXPECT_NEAR(outcome.ratio_interval->highest, 1 + 2.920 * 0.03 / std::sqrt(3), 1e-5);
}

TEST(Validation, IsOpenIfTheIntervalContainsAnEndAndFailsIfItIsOutside) {
  EXPECT_EQ(judge(within(0.1), specimens({9, 10, 11})).light, ClaimLight::kYellow) << "the mean alone is inside";
  EXPECT_EQ(judge(within(0.1), specimens({11, 13, 15})).light, ClaimLight::kYellow);
  EXPECT_EQ(judge(within(0.1), specimens({12.9, 13, 13.1})).light, ClaimLight::kRed);
  EXPECT_EQ(judge(within(0.1), specimens({7.9, 8, 8.1})).light, ClaimLight::kRed);
  const ClaimOutcome one = judge(within(0.1), specimens({10}));
  EXPECT_EQ(one.light, ClaimLight::kYellow) << "one specimen has no interval";
  EXPECT_FALSE(one.ours->standard_error);
  EXPECT_FALSE(one.ratio_interval);
  EXPECT_EQ(judge(within(0.1), specimens({10, 10})).light, ClaimLight::kGreen) << "without scatter two suffice";
}

TEST(Validation, KnowsFactorsAndRanges) {
  Claim factor = within(0.1);
  factor.within.reset();
  factor.factor = 2;
  EXPECT_EQ(judge(factor, specimens({18, 18.5, 18.2})).light, ClaimLight::kGreen);
  EXPECT_EQ(judge(factor, specimens({5.3, 5.4, 5.5})).light, ClaimLight::kGreen);
  EXPECT_EQ(judge(factor, specimens({17, 19, 23})).light, ClaimLight::kYellow);
  EXPECT_EQ(judge(factor, specimens({4.4, 4.5, 4.6})).light, ClaimLight::kRed);
  const ClaimOutcome wide = judge(factor, specimens({5, 15}));
  EXPECT_NEAR(wide.ratio_interval->lowest * wide.ratio_interval->highest, 1, 1e-9) << "symmetric in logarithms";

  Claim range = within(0.1);
  range.within.reset();
  range.expected = 0;
  range.accepted = Range{-1, 1};
  EXPECT_EQ(judge(range, specimens({0.8, 0.9})).light, ClaimLight::kYellow);
  EXPECT_EQ(judge(range, specimens({0.89, 0.9})).light, ClaimLight::kGreen);
  EXPECT_EQ(judge(range, specimens({1.89, 1.9})).light, ClaimLight::kRed);
  EXPECT_FALSE(judge(range, specimens({0.9})).ratio) << "nothing is a multiple of 0";
  EXPECT_NEAR(judge(range, specimens({-0.1, 0.1})).spread, 0.1 * std::sqrt(2), 1e-12) << "over half the tolerance";
}

/// Fractions of simulated validations with each light, with 3 specimens and 2 more where their spread is wide.
std::array<double, 3> lightsAt(double truth, double sd, double tolerance) {
  constexpr int kTimes = 4000;
  std::mt19937_64 random(7);
  std::normal_distribution<double> specimen(10 * truth, 10 * sd);
  std::array<double, 3> fractions{};
  for (int i = 0; i < kTimes; ++i) {
    std::vector<double> ours{specimen(random), specimen(random), specimen(random)};
    if (judge(within(tolerance), specimens(ours)).spread > kWideSpread) {
      for (std::size_t more = 0; more < kMoreSpecimens; ++more) {
        ours.push_back(specimen(random));
      }
    }
    fractions.at(static_cast<std::size_t>(judge(within(tolerance), specimens(ours)).light)) += 1.0 / kTimes;
  }
  return fractions;
}

TEST(Validation, IsRarelyWrongInSimulatedValidations) {
  for (const double sd : {0.02, 0.1, 0.15, 0.2, 0.3}) {
    constexpr double kTolerance = 0.4;
    const double most = sd < kWideSpread ? 0.065 : 0.085;  // the second decision costs up to 3 %
    const std::array<double, 3> at_end = lightsAt(1 + kTolerance, sd, kTolerance);
    EXPECT_LT(at_end[0], most) << "holds at the end of the tolerance, SD " << sd;
    EXPECT_LT(at_end[2], most) << "fails there, SD " << sd;
    EXPECT_LT(lightsAt(1.5, sd, kTolerance)[0], most) << "holds outside, SD " << sd;
    EXPECT_LT(lightsAt(1.3, sd, kTolerance)[2], most) << "fails inside, SD " << sd;
  }
  EXPECT_GT(lightsAt(1, 0.1, 0.4)[0], 0.9) << "has power";
  EXPECT_GT(lightsAt(2, 0.1, 0.4)[2], 0.9);
}

TEST(Validation, ComparesEachSpecimenWithItsOwnTheory) {
  Claim claim = within(0.1);
  claim.expected.reset();
  const ClaimOutcome outcome =
      judge(claim, {{.ours = 10, .other = 10, .why_not = ""}, {.ours = 30, .other = 30, .why_not = ""}});
  EXPECT_EQ(outcome.light, ClaimLight::kGreen);
  EXPECT_DOUBLE_EQ(*outcome.ratio->standard_error, 0) << "ratios, not numbers, have the scatter";
  EXPECT_DOUBLE_EQ(outcome.other->mean, 20);
  const ClaimOutcome scattering = judge(claim, {{.ours = 10, .other = 5, .why_not = ""},
                                                {.ours = 10, .other = 20, .why_not = ""},
                                                {.ours = 10, .other = 5, .why_not = ""}});
  EXPECT_DOUBLE_EQ(scattering.ratio->mean, 1) << "of the means: the mean of the ratios is 1.5";
  EXPECT_NEAR(*scattering.ratio->standard_error, 0.5, 1e-12);
}

TEST(Validation, ASpecimenWithoutANumberMakesItRed) {
  const ClaimOutcome outcome =
      judge(within(0.1), {{.ours = 10, .other = {}, .why_not = ""}, {.ours = {}, .other = {}, .why_not = "clogged"}});
  EXPECT_EQ(outcome.light, ClaimLight::kRed);
  EXPECT_EQ(outcome.specimens, 1U);
  EXPECT_EQ(outcome.why_not, "clogged");
  EXPECT_FALSE(judge(within(0.1), {{.ours = {}, .other = {}, .why_not = "clogged"}}).ours);
}

TEST(Validation, RefusesNonsense) {
  const auto refused = [](const std::function<void(Claim&)>& spoil) {
    Claim claim = within(0.1);
    spoil(claim);
    EXPECT_THROW(validate(claim), InvalidParameter);
  };
  EXPECT_NO_THROW(validate(within(0.1)));
  refused([](Claim& c) { c.within.reset(); });
  refused([](Claim& c) { c.factor = 2; });
  refused([](Claim& c) { c.within = -0.1; });
  refused([](Claim& c) {
    c.within.reset();
    c.factor = 0.5;
  });
  refused([](Claim& c) { c.expected = 0; });
}

TEST(Validation, PageCountsLightsAndSaysWhatIsMissingAndWhy) {
  Claim noted = within(0.1);
  noted.note = "It is so.";
  Claim other_group = within(0.1);
  other_group.group = "Plates";
  other_group.kind = ClaimKind::kCalibrated;
  const std::string page = validationPage({{within(0.1), judge(within(0.1), specimens({10, 10.2}))},
                                           {noted, judge(noted, specimens({20, 20.2}))},
                                           {other_group, {}}},
                                          {"How it was made."}, true);
  EXPECT_THAT(
      page, AllOf(HasSubstr("Of 2 independent claims 1 hold, 0 are open and 1 fail. Not simulated yet: 1."),
                  ContainsRegex(R"(\| independent: [^|]* \| 2 \| 1 \| 0 \| 1 \|)"),
                  ContainsRegex(R"(\| calibrated: [^|]* \| 1 \| 0 \| 0 \| 0 \|)"), Not(HasSubstr("self-consistency")),
                  HasSubstr("| all | 3 | 1 | 0 | 1 |"), HasSubstr("How it was made."),
                  HasSubstr("](validation-newton.svg)"), Not(HasSubstr("validation-plates")), HasSubstr("## Newton"),
                  HasSubstr("## Plates"), HasSubstr("| 10.1 ± 0.100 N | 1.01 ± 0.0100 | ± 10 % | 2 | 🟢 holds |"),
                  HasSubstr("- `weight`: It is so."), HasSubstr("not simulated yet |")));
  noted.claim = "a | b";
  EXPECT_THAT(validationPage({{noted, {}}}, {}, false), HasSubstr("a \\| b |")) << "what would end a cell";
  EXPECT_THAT(validationPage({{within(0.1), judge(within(0.1), specimens({10}))}}, {}, false),
              AllOf(Not(HasSubstr("![")), Not(HasSubstr("ot simulated yet"))));
}

TEST(Validation, GroupsKeepTheirOrderAndHaveFiguresOfTheirOwn) {
  Claim other_group = within(0.1);
  other_group.group = "Flow and heaps";
  EXPECT_THAT(groupsOf({within(0.1), other_group, within(0.1)}), testing::ElementsAre("Newton", "Flow and heaps"));
  EXPECT_THAT(figureNamesOf({"Flow and heaps", "Sand 1", "Sand-1", "\u7802"}),
              testing::ElementsAre("validation-flow-and-heaps.svg", "validation-sand-1.svg", "validation-sand-1-2.svg",
                                   "validation----.svg"));
  const auto file = std::filesystem::path(testing::TempDir()) / "claims.svg";
  std::filesystem::remove(file);  // left by an earlier run
  const std::vector<JudgedClaim> claims{{within(0.1), judge(within(0.1), specimens({10}))}, {other_group, {}}};
  EXPECT_FALSE(drawValidation(file, claims, "Flow and heaps")) << "nothing is measured of it";
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_TRUE(drawValidation(file, claims, "Newton"));
  EXPECT_TRUE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace haptolith
