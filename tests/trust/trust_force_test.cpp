#include "haptolith/trust/trust_force.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr double kDuration_s = 2;

TrustRun runOf(const std::vector<std::string>& overrides = {}, TrustChange change = TrustChange::kNone) {
  return *planned(changed(findSceneFile("icra2021"), overrides), change, 0).run;
}

TEST(TrustForce, SummarisesTheMovement) {
  const TrustForce force = measureForce(runOf({"hand.motion='press'", "hand.compliance='rigid'"}), kDuration_s, 1);
  EXPECT_GT(force.mean_n, 0);
  EXPECT_GT(force.peak_n, force.mean_n);
  EXPECT_EQ(force.particles, 256U);
  EXPECT_NEAR(force.reach.depth_m, 0.02 + 0.005 / 2, 5e-4) << "the hand's depth and half of the tool's height";
  EXPECT_NEAR(force.reach.to_floor_m, force.surface_m - force.reach.depth_m, 1e-9);
  EXPECT_NEAR(force.reach.to_wall_x_m, 0.063 - 0.025, 2e-3);
  EXPECT_GT(force.work_j, 0);
  EXPECT_LT(force.energy_gain_j, force.work_j) << "soil makes no energy";
}

TEST(TrustForce, IsTheSameOnAnyNumberOfThreadsAndEveryTime) {
  const TrustForce one = measureForce(runOf(), kDuration_s, 1), two = measureForce(runOf(), kDuration_s, 2);
  EXPECT_GT(one.mean_n, 0) << "else nothing has moved";
  EXPECT_EQ(one.hash, two.hash);
  EXPECT_EQ(one.mean_n, two.mean_n);
  const TrustBits bits = checkBits(runOf(), kDuration_s);
  EXPECT_TRUE(bits.threads);
  EXPECT_TRUE(bits.restart);
}

TEST(TrustForce, SaysHowLargeRoundingIs) {
  EXPECT_FALSE(checkBits(runOf({"soil.friction_model='icra2021'"}), kDuration_s).rounding) << "no double step of it";
  const TrustBits bits = checkBits(runOf({"soil.friction_model='contact'"}), kDuration_s);
  ASSERT_TRUE(bits.rounding);
  EXPECT_GT(*bits.rounding, 0);
  EXPECT_LT(*bits.rounding, 1e-3);
}

TEST(TrustForce, TakesStepsHalfAsLong) {
  const TrustForce usual = measureForce(runOf(), kDuration_s, 1);
  const TrustForce halved = measureForce(runOf({}, TrustChange::kStep), kDuration_s, 1);
  EXPECT_EQ(halved.substeps, 2 * usual.substeps);
  EXPECT_NE(halved.hash, usual.hash);
}

// A hand whose surface is given moves as deep below that of deeper soil.
TEST(TrustForce, FollowsTheSurfaceOfDeeperSoil) {
  const std::vector<std::string> overrides{"hand.motion='press'", "hand.compliance='rigid'", "hand.surface_mm=36"};
  const TrustForce usual = measureForce(runOf(overrides), kDuration_s, 1);
  TrustRun deep = runOf(overrides, TrustChange::kDeep);
  deep.usual_surface_m = usual.surface_m;
  const TrustForce below = measureForce(deep, kDuration_s, 1);
  EXPECT_GT(below.surface_m, usual.surface_m + 0.02);
  EXPECT_NEAR(below.reach.depth_m, usual.reach.depth_m, 1e-6);
}

// Far apart, each of two tools meets the force that it meets alone.
TEST(TrustForce, IsThatOfTheFirstOfSeveralTools) {
  const std::string soil = "[bed]\nwidth_mm = 400\nparticles = 800\n";
  const std::string left = "[hand]\nmotion = 'press'\ncompliance = 'rigid'\nhome_mm = [-150, 0, 85]\n";
  const SceneFile alone = sceneFileFromText(soil + left, "alone");
  SceneFile both = sceneFileFromText(
      soil + left +
          "[[tools]]\nname = 'left'\n[[tools]]\nname = 'right'\n[tools.hand]\nhome_mm = [150, 0, 85]\ndepth_mm = 10\n",
      "both");
  const auto force = [](const SceneFile& scene) {
    return measureForce(*planned(scene, TrustChange::kNone, 0).run, kDuration_s, 1);
  };
  const TrustForce of_left = force(both);
  EXPECT_EQ(of_left.mean_n, force(alone).mean_n);
  exchangeFirst(both, toolNumber(both, "right"));
  const TrustForce of_right = force(both);
  EXPECT_LT(of_right.reach.depth_m, of_left.reach.depth_m - 0.005);
  EXPECT_NE(of_right.mean_n, of_left.mean_n);
  const TrustBits bits = checkBits(*planned(both, TrustChange::kNone, 0).run, 1);
  EXPECT_TRUE(bits.threads && bits.restart);
}

TEST(TrustForce, CanBeInterrupted) {
  EXPECT_THROW(
      (void)measureForce(runOf(), kDuration_s, 1, [](std::string_view, double fraction) { return fraction < 0.6; }),
      Failure);
}

TEST(TrustForce, RefusesAMovementThatLeaves) {
  EXPECT_THROW((void)measureForce(runOf({"hand.home_mm=[5000, 0, 85]"}), kDuration_s, 1), Failure);
}

}  // namespace
}  // namespace haptolith
