#include "haptolith/teleop/bench/simulation.h"

#include <gmock/gmock.h>

#include <cmath>

#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/identify/training/training_file.h"
#include "haptolith/teleop/link/link_profiles.h"
#include "haptolith/teleop/operator/learning_model.h"

namespace haptolith {
namespace {

/// The paper's small bed on both sides, with contact friction; a stiff hand that presses and lifts.
TeleopSetup smallSetup(double round_trip_s) {
  TeleopSetup setup;
  setup.model.bed.soil.friction = FrictionModel::kContact;
  setup.model.hand.motion = HandMotion::kCut;
  setup.model.hand.depth_m = 0.01;
  setup.model.hand.period_s = 12;
  setup.model.hand.compliance = HandCompliance::kRigid;
  setup.site = setup.model;
  setup.up.delay_s = setup.down.delay_s = round_trip_s / 2;
  setup.duration_s = 10;
  return setup;
}

std::vector<double> metOf(const TeleopResult& result) {
  std::vector<double> met;
  for (const AgreementPoint& window : result.agreement.windows()) {
    met.push_back(window.met_n.x());
  }
  return met;
}

/// Mean size of the force that was felt over that of the one that was met.
double feltOverMet(const TeleopResult& result, double from_s, double to_s) {
  double displayed_n = 0, met_n = 0;
  for (const AgreementPoint& window : result.agreement.windows()) {
    if (window.time_s >= from_s && window.time_s < to_s) {
      displayed_n += window.displayed_n.norm();
      met_n += window.met_n.norm();
    }
  }
  return displayed_n / met_n;
}

TEST(TeleopSimulation, TheSameBedOnBothSidesGivesTheSameForce) {
  TeleopSetup setup;
  setup.model = findSceneFile("teleop-model", std::vector<std::string>{"soil.radius_mm=7", "bed.width_mm=126",
                                                                       "bed.length_mm=126", "hand.period_s=12"});
  setup.model.hand.compliance = HandCompliance::kRigid;
  setup.model.hand.reach_m = 0.02;
  setup.model.hand.depth_m = 0;
  setup.site = setup.model;
  setup.up.delay_s = setup.down.delay_s = 1.3;
  setup.robot.sensor.noise_n = setup.robot.sensor.noise_nm = 0;
  setup.duration_s = 8;
  const TeleopResult result = simulateTeleop(setup);
  EXPECT_GT(result.agreement.rmsMet(0, 8), 1);
  EXPECT_LT(result.agreement.share(0, 8), 0.3) << "grains magnify what the robot's arm yields";
  EXPECT_LT(result.free_m, 1e-3);
  EXPECT_LT(result.soil_m, 3e-3);
  EXPECT_NEAR(result.behind_s, 2.65, 0.1);
  EXPECT_EQ(result.stops, 0U);
  EXPECT_LE(result.given_j, 1e-3);
}

TEST(TeleopSimulation, TheSameSetupGivesTheSameBits) {
  TeleopSetup setup = smallSetup(0.4);
  setup.up.jitter_s = setup.down.jitter_s = 0.05;
  setup.up.loss = setup.down.loss = 0.1;
  setup.duration_s = 5;
  const TeleopResult one = simulateTeleop(setup);
  const TeleopResult two = simulateTeleop(setup);
  EXPECT_EQ(metOf(one), metOf(two));
  EXPECT_EQ(one.soil_m, two.soil_m);
  EXPECT_EQ(one.up, two.up);
  EXPECT_GT(one.up.lost, 0U);
}

struct Trouble {
  const char* name;
  void (*make)(TeleopSetup&);
};

void PrintTo(const Trouble& trouble, std::ostream* out) {
  *out << trouble.name;
}

class WhateverTheLinkDoes : public testing::TestWithParam<Trouble> {};

TEST_P(WhateverTheLinkDoes, TheRobotIsWhereTheCommandOfItsIndexWas) {
  TeleopSetup setup = smallSetup(0.85);
  GetParam().make(setup);
  setup.duration_s = 20;
  const TeleopResult result = simulateTeleop(setup);
  EXPECT_LT(result.free_m, 1e-3);
  EXPECT_LT(result.soil_m, 3e-3);
  EXPECT_GT(result.followed_share, 0.95);
  EXPECT_EQ(result.stops, 0U);
  EXPECT_GT(result.agreement.windows().size(), 80U) << "and its reports come";
}

INSTANTIATE_TEST_SUITE_P(
    Links, WhateverTheLinkDoes,
    testing::Values(Trouble{"jitter", [](TeleopSetup& setup) { setup.up.jitter_s = setup.down.jitter_s = 0.2; }},
                    Trouble{"loss", [](TeleopSetup& setup) { setup.up.loss = setup.down.loss = 0.3; }},
                    Trouble{"overtaking",
                            [](TeleopSetup& setup) {
                              setup.up.in_order = setup.down.in_order = false;
                              setup.up.jitter_s = setup.down.jitter_s = 0.1;
                              setup.up.duplicate = setup.down.duplicate = 0.2;
                            }},
                    Trouble{"one way slower",
                            [](TeleopSetup& setup) {
                              setup.up.delay_s = 0.8;
                              setup.down.delay_s = 0.05;
                            }},
                    Trouble{"changing delay",
                            [](TeleopSetup& setup) {
                              setup.up.delays = {{0, 0.2}, {4, 0.5}, {8, 0.1}, {12, 0.6}};
                            }},
                    Trouble{"a clock that is too fast", [](TeleopSetup& setup) { setup.robot_clock_share = 5e-3; }},
                    Trouble{"a clock that is too slow", [](TeleopSetup& setup) { setup.robot_clock_share = -5e-3; }},
                    Trouble{"256 kbit/s",
                            [](TeleopSetup& setup) {
                              setup.up.rate_bit_s = setup.down.rate_bit_s = 256e3;
                              setup.sending = sendingOver(setup.up, setup.down);
                            }}),
    [](const auto& link) {
      std::string name = link.param.name;
      std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
      return name;
    });

TEST(TeleopSimulation, SixtyFourKilobitsASecondCarryItFiveTimesASecond) {
  TeleopSetup setup = smallSetup(2.6);
  setup.up.rate_bit_s = setup.down.rate_bit_s = 64e3;
  setup.sending = sendingOver(setup.up, setup.down);
  const TeleopResult result = simulateTeleop(setup);
  EXPECT_LT(result.free_m, 1e-3);
  EXPECT_LT(result.soil_m, 3e-3);
  EXPECT_EQ(result.up.dropped + result.down.dropped, 0U);
}

TEST(TeleopSimulation, BurstsOfLossStopItAtWorst) {
  TeleopSetup setup = smallSetup(0.85);
  for (LinkParameters* way : {&setup.up, &setup.down}) {  // 30 %, 25 packets at a time
    way->turns_good = 1.0 / 25;
    way->turns_bad = way->turns_good * 0.3 / 0.7;
  }
  setup.duration_s = 40;
  const TeleopResult result = simulateTeleop(setup);
  EXPECT_LT(result.free_m, 1e-3);
  EXPECT_LT(result.soil_m, 3e-3);
  EXPECT_GT(result.followed_share, 0.7);
}

TEST(TeleopSimulation, AnOutageOfTenSecondsEndsInTheAirAndGoesOn) {
  TeleopSetup setup = smallSetup(0.4);
  setup.up.outages = setup.down.outages = {{.start_s = 6, .duration_s = 10}};
  setup.duration_s = 40;
  const TeleopResult result = simulateTeleop(setup);
  EXPECT_GE(result.stops, 1U);
  EXPECT_EQ(result.last_stop, StopReason::kNone) << "it has got over it";
  EXPECT_LT(result.free_m, 1e-3);
  EXPECT_GT(result.followed_share, 0.5);
}

TEST(TeleopSimulation, DelayedForceIsTrueWithoutDelayAndUselessWithIt) {
  TeleopSetup setup = smallSetup(0);
  setup.feedback = Feedback::kBilateral;
  const TeleopResult at_once = simulateTeleop(setup);
  EXPECT_LT(at_once.agreement.share(0, 10), 0.15);
  EXPECT_LT(at_once.soil_m, 3e-3);
  setup.up.delay_s = setup.down.delay_s = 1.3;
  const TeleopResult late = simulateTeleop(setup);
  EXPECT_GT(late.agreement.share(0, 10), 0.8);
  EXPECT_GT(late.taken_back_j, 0);
}

// Lunar soil as the model, weaker soil of stiffer grains at the site; large grains, so that it takes seconds.
TEST(TeleopSimulation, AModelThatLearnsBecomesWhatTheRobotMeetsAndNobodyFeelsIt) {
  TeleopSetup setup;
  setup.model = readyToLearn(findSceneFile(
      "teleop-model", std::vector<std::string>{"soil.radius_mm=9", "bed.sleep_distance_mm=0.09", "hand.period_s=24"}));
  setup.site = findSceneFile("teleop-site", std::vector<std::string>{"soil.radius_mm=8", "bed.sleep_distance_mm=0.08",
                                                                     "soil.stiffness_n_m=5000"});
  setup.up.delay_s = setup.down.delay_s = 0.2;
  setup.duration_s = 7;
  const TeleopResult stays = simulateTeleop(setup);
  EXPECT_EQ(stays.updates, 0U);
  EXPECT_GT(stays.agreement.share(0, 7), 1);
  EXPECT_GT(feltOverMet(stays, 0, 7), 2);
  setup.learns.emplace(probeTraining().runs);
  const TeleopResult short_run = simulateTeleop(setup), again = simulateTeleop(setup);
  EXPECT_EQ(metOf(short_run), metOf(again)) << "the same on every run";
  EXPECT_EQ(short_run.learned->state.cohesion_pa, again.learned->state.cohesion_pa);
  setup.duration_s = 24;
  const TeleopResult learns = simulateTeleop(setup);
  EXPECT_LT(learns.agreement.share(12, 24), 0.8) << "two specimens of grains so large differ by half";
  EXPECT_GT(feltOverMet(learns, 12, 24), 0.7);
  EXPECT_LT(feltOverMet(learns, 12, 24), 1.4);
  EXPECT_GT(learns.updates, 10U);
  EXPECT_LT(learns.update_j, 1e-3);
  EXPECT_EQ(learns.update_jump, 0) << "soil changes while the tool is lifted";
  EXPECT_LE(learns.given_j, 1e-3);
  ASSERT_TRUE(learns.learned);
  EXPECT_LT(learns.learned->state.cohesion_pa, 350) << "the model began with 545";
}

TEST(TeleopSimulation, AModelsSurfaceIsMendedWhileTheToolIsInTheAir) {
  TeleopSetup setup;
  setup.model = findSceneFile("teleop-model", std::vector<std::string>{"soil.radius_mm=10", "hand.period_s=12"});
  setup.site = findSceneFile("teleop-site", std::vector<std::string>{"soil.radius_mm=10", "soil.stiffness_n_m=3000"});
  setup.duration_s = 12;
  const TeleopResult left = simulateTeleop(setup);
  setup.mends = true;
  const TeleopResult mended = simulateTeleop(setup);
  EXPECT_EQ(left.mended, 0U);
  EXPECT_GT(mended.mended, 0U);
  // docs/reports/teleop-bench.md has finer particles, whose surfaces differ less.
  EXPECT_LT(mended.apart_surface_m, left.apart_surface_m + 0.005) << "half the radius of a grain, which is rough";
  EXPECT_LE(mended.given_j, 1e-3);
}

TEST(TeleopSimulation, ATaskEndsWhenItIsSeenToBeDoneAtTheSite) {
  TeleopSetup setup = smallSetup(0.4);
  setup.task = SiteTask::kPress;
  setup.duration_s = 60;
  const TeleopResult result = simulateTeleop(setup);
  ASSERT_TRUE(result.task);
  EXPECT_LT(result.task->done_s, 20);
  EXPECT_NEAR(result.task->done_s, result.duration_s, 2e-3) << "the run ends with it";
  EXPECT_NEAR(result.task->reached, 8, 0.8);
  EXPECT_EQ(simulateTeleop(setup).task->done_s, result.task->done_s);
  setup.duration_s = 1;
  EXPECT_TRUE(std::isnan(simulateTeleop(setup).task->done_s)) << "no time for it";
  setup.feedback = Feedback::kBilateral;
  setup.up.delay_s = setup.down.delay_s = 0;
  setup.duration_s = 60;
  const TeleopResult by_force = simulateTeleop(setup);
  EXPECT_LT(by_force.task->done_s, 60);
  EXPECT_GT(by_force.task->done_s, result.task->done_s) << "who has no model moves and waits";
  setup.task.reset();
  setup.duration_s = 1;
  EXPECT_FALSE(simulateTeleop(setup).task);
}

TEST(TeleopSimulation, WhoFeelsNothingGoesByWhatTheRobotMet) {
  TeleopSetup setup = smallSetup(0.4);
  setup.feedback = Feedback::kNone;
  setup.task = SiteTask::kPress;
  setup.duration_s = 120;
  const TeleopResult result = simulateTeleop(setup);
  EXPECT_NEAR(result.task->reached, 8, 0.8);
  EXPECT_NEAR(result.agreement.share(0, 120), 1, 1e-9) << "all that was met was not felt";
  EXPECT_EQ(result.given_j, 0);
  setup.feedback = Feedback::kModel;
  EXPECT_GT(result.task->done_s, simulateTeleop(setup).task->done_s) << "who has no model moves and waits";
  setup.feedback = Feedback::kNone;
  setup.learns.emplace(probeTraining().runs);
  EXPECT_THROW((void)simulateTeleop(setup), InvalidParameter) << "there is no model to learn";
  setup.learns.reset();
  setup.mends = true;
  EXPECT_THROW((void)simulateTeleop(setup), InvalidParameter) << "nor to mend";
  setup.feedback = Feedback::kModel;
  setup.model = findSceneFile("fine-grains");
  EXPECT_THROW((void)simulateTeleop(setup), InvalidParameter) << "of several sizes";
}

TEST(TeleopSimulation, AHandThatLetsGoStopsTheRobotAndIsGivenNothing) {
  TeleopSetup setup = smallSetup(0.4);
  setup.duration_s = 8;
  setup.release_s = 2.6;  // in the soil
  const TeleopResult result = simulateTeleop(setup);
  EXPECT_EQ(result.last_stop, StopReason::kReleased);
  EXPECT_GT(result.agreement.rmsMet(0, 4), 0) << "it had begun";
  EXPECT_LT(result.followed_share, 0.4);
  EXPECT_LE(result.given_j, 1e-3);
  setup.release_s = 0;  // no hand was ever there
  EXPECT_EQ(simulateTeleop(setup).followed_share, 0);
  setup.task = SiteTask::kPress;
  EXPECT_THROW((void)simulateTeleop(setup), InvalidParameter);
}

TEST(TeleopSimulation, WhatTheOperatorKnowsOfTheSiteIsTrueAfterARoundTripAndASecond) {
  TeleopSetup setup = smallSetup(0.4);
  setup.up.jitter_s = setup.down.jitter_s = 0.05;
  setup.up.loss = setup.down.loss = 0.3;
  const TeleopResult result = simulateTeleop(setup);
  EXPECT_GT(result.known_surface_m, 0) << "something was dug";
  EXPECT_LT(result.known_surface_m, setup.site.bed.soil.radius_m / 2);
  EXPECT_GT(result.apart_surface_m, 0);
}

TEST(TeleopSimulation, EndsWhenNobodyWantsItAnyMore) {
  EXPECT_THROW((void)simulateTeleop(smallSetup(0), [](double share) { return share < 0.1; }), Failure);
}

TEST(TeleopSimulation, RefusesNonsense) {
  TeleopSetup setup = smallSetup(0);
  setup.sending.period_s = 0;
  EXPECT_THROW((void)simulateTeleop(setup), InvalidParameter);
  setup = smallSetup(0);
  setup.sending.site_period_s = 0;
  EXPECT_THROW((void)simulateTeleop(setup), InvalidParameter);
  setup = smallSetup(0);
  setup.site.loop.tick_s = 2e-3;
  EXPECT_THROW((void)simulateTeleop(setup), InvalidParameter);
  setup = smallSetup(-1);
  EXPECT_THROW((void)simulateTeleop(setup), InvalidParameter);
}

TEST(ForceAgreement, IsTheRootOfMeanSquaresOfWindowsInAnyOrder) {
  ForceAgreement agreement;
  for (int i = 40; i >= 1; --i) {
    const double met = i <= 20 ? 4 : 2;
    agreement.add(0.02 * i, 0.02, {met + 1, 0, 0}, {met, 0, 0});
  }
  agreement.add(0.82, 0.02, {100, 0, 0}, {1, 0, 0});  // an unknown window
  ASSERT_EQ(agreement.windows().size(), 4U);
  EXPECT_NEAR(agreement.windows()[0].time_s, 0.1, 1e-12);
  EXPECT_NEAR(agreement.rmsMet(0, 1), std::sqrt((16 + 4) / 2.0), 1e-12);
  EXPECT_NEAR(agreement.rmsDifference(0, 1), 1, 1e-12);
  EXPECT_NEAR(agreement.share(0.4, 0.8), 0.5, 1e-12);
  EXPECT_TRUE(std::isnan(agreement.share(5, 6)));
}

TEST(DisplayedForceTrack, IsTheMeanOverAnyStretchThatIsKnown) {
  DisplayedForceTrack track;
  for (std::uint64_t i = 0; i < 100000; ++i) {
    track.add(i, {static_cast<double>(i), 0, 1});
  }
  EXPECT_NEAR(track.mean(99000, 99010)->x(), 99005.5, 1e-6);
  EXPECT_FALSE(track.mean(99000, 99000));
  EXPECT_FALSE(track.mean(99990, 100000)) << "not yet";
  EXPECT_FALSE(track.mean(100, 200)) << "over";
}

TEST(MeanSurfaceHeight, OfOneLayerOfSpheresIsWhatTheyAreFromAbove) {
  BedParameters bed;
  bed.start = BedStart::kPacked;
  Bed packed(bed);
  const double highest_m = packed.surfaceHeight();
  const double mean_m = meanSurfaceHeight(packed);
  EXPECT_LT(mean_m, highest_m);
  EXPECT_GT(mean_m, highest_m - 2 * bed.soil.radius_m);
}

}  // namespace
}  // namespace haptolith
