// A tool that meets stones: it carries, pushes and feels them, and they do not pass its walls.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/scene/scene.h"

namespace haptolith {
namespace {

constexpr double kMoon_m_s2 = 1.625;

BedParameters boxWith(const PlacedStone& stone) {
  BedParameters bed;
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.stiffness_n_m = 400;
  bed.soil.gamma_nm = linearGamma(bed.soil);
  bed.gravity_m_s2 = {0, 0, -kMoon_m_s2};
  bed.width_m = bed.length_m = 1;
  bed.stones.placed = {stone};
  return bed;
}

/// A box of which one particle in a corner is all the soil, and a stone whose middle is so high above the floor.
Scene sceneWith(PlacedStone stone, double height_m, const ToolParameters& tool) {
  stone.depth_m = 0.014 - height_m;  // the particle's top is the surface
  return {boxWith(stone), tool, std::vector<Vec3>{{-0.48, -0.48, 0.007}}};
}

PlacedStone rock(double size_m) {
  return {.size_m = size_m, .seed = 5};
}

/// Flat and wide: a rock on a plate keeps rocking for long, because rolling is free of losses.
PlacedStone slab() {
  PlacedStone stone{.form = StoneForm::kSpheres};
  for (const double x : {-0.01, 0.0, 0.01}) {
    for (const double y : {-0.01, 0.0, 0.01}) {
      stone.spheres.push_back({Vec3(x, y, 0), 0.006});
    }
  }
  return stone;
}

/// Moves the tool along a straight line at a steady speed.
void moveTool(Scene& scene, const Vec3& to_m, double time_s) {
  const Pose from = scene.toolPose();
  const int ticks = static_cast<int>(std::lround(time_s / 1e-3));
  HandState hand{{from, {}}};
  hand.twist.linear_m_s = (to_m - from.position_m) / time_s;
  for (int i = 1; i <= ticks; ++i) {
    hand.pose.position_m = from.position_m + (to_m - from.position_m) * i / ticks;
    ASSERT_EQ(scene.tick(hand), StepStatus::kOk);
  }
}

void holdTool(Scene& scene, double time_s) {
  moveTool(scene, scene.toolPose().position_m, time_s);
}

TEST(ToolAndStones, AStoneOnTheToolWeighsWhatItWeighs) {
  ToolParameters shovel;
  Scene scene = sceneWith(slab(), 0.111, shovel);
  scene.placeTool({{{Vec3(0, 0, 0.1), Quat::Identity()}, {}}});
  holdTool(scene, 3);
  const double weight_n = scene.bed().stones().mass(0) * kMoon_m_s2;
  const Wrench felt = scene.soilWrench();
  EXPECT_NEAR(felt.force_n.z(), -weight_n, 1e-3 * weight_n);
  EXPECT_NEAR(felt.force_n.head<2>().norm(), 0, 1e-3 * weight_n);
  // Its torque is that of a weight where the stone lies.
  const Vec3 lever = scene.bed().stones().pose(0).position_m - scene.toolPose().position_m;
  EXPECT_LT((felt.torque_nm - lever.cross(Vec3(0, 0, -weight_n))).norm(), 1e-3 * weight_n * 0.03);
  EXPECT_LT(scene.bed().stones().largestSpeed(), 1e-3);
}

TEST(ToolAndStones, FrictionCarriesAStoneSidewaysUpToItsLimit) {
  ToolParameters shovel;
  shovel.friction = 0.4;  // holds 0.65 m/s^2 on the Moon
  Scene scene = sceneWith(slab(), 0.111, shovel);
  scene.placeTool({{{Vec3(0, 0, 0.1), Quat::Identity()}, {}}});
  holdTool(scene, 3);
  const Vec3 on_tool = scene.bed().stones().pose(0).position_m - scene.toolPose().position_m;
  HandState hand{{scene.toolPose(), {}}};
  for (int i = 1; i <= 600; ++i) {  // 0.4 m/s^2
    const double t = 1e-3 * i;
    hand.pose.position_m = Vec3(0.2 * t * t, 0, 0.1);
    hand.twist.linear_m_s = Vec3(0.4 * t, 0, 0);
    ASSERT_EQ(scene.tick(hand), StepStatus::kOk);
  }
  EXPECT_NEAR(scene.soilWrench().force_n.x(), -0.4 * scene.bed().stones().mass(0),
              0.05 * 0.4 * scene.bed().stones().mass(0));
  EXPECT_LT((scene.bed().stones().pose(0).position_m - scene.toolPose().position_m - on_tool).norm(), 5e-4);
}

/// A wall of 1 mm that is driven sideways at 1 m/s against a stone on the floor pushes it ahead.
TEST(ToolAndStones, NoStonePassesAThinWallAtOneMetreASecond) {
  for (const StoneForm form : {StoneForm::kRock, StoneForm::kSphere}) {
    ToolParameters wall;
    wall.size_m = {0.06, 0.08, 0.001};  // upright, its large faces along x
    wall.stiffness_n_m = 2000;
    PlacedStone stone = rock(0.04);
    stone.form = form;
    Scene scene = sceneWith(stone, 0.03, wall);
    const Quat upright(Eigen::AngleAxisd(-std::numbers::pi / 2, Vec3::UnitY()));
    scene.placeTool({{{Vec3(-0.15, 0, 0.04), upright}, {}}});
    holdTool(scene, 1);
    double nearest_m = 1;
    for (int i = 0; i < 4; ++i) {
      moveTool(scene, scene.toolPose().position_m + Vec3(0.07, 0, 0), 0.07);
      if (std::abs(scene.bed().stones().pose(0).position_m.y()) < 0.04) {  // it has not rolled off sideways
        nearest_m = std::min(nearest_m, scene.bed().stones().pose(0).position_m.x() - scene.toolPose().position_m.x());
      }
    }
    EXPECT_GT(nearest_m, 0.005) << "its middle is where the wall is, or behind it";
  }
}

TEST(ToolAndStones, ATurningStoneRubsOnTheTool) {
  ToolParameters plate;
  plate.shape = ToolShape::kPlate;
  plate.diameter_m = 0.2;
  PlacedStone ball = rock(0.04);
  ball.form = StoneForm::kSphere;
  Scene scene = sceneWith(ball, 0.1225 + 0.02, plate);
  scene.placeTool({{{Vec3(0, 0, 0.12), Quat::Identity()}, {}}});
  holdTool(scene, 2);
  Stones& stones = scene.bed().stones();
  stones.place(0, stones.pose(0), {Vec3::Zero(), Vec3(0, 20, 0)});
  holdTool(scene, 0.05);
  EXPECT_GT(stones.twist(0).linear_m_s.x(), 0.01) << "it rolls off along x";
  EXPECT_LT(scene.soilWrench().force_n.x(), 0) << "and pushes the tool back";
}

TEST(ToolAndStones, GoOnFromASavedSceneBitForBit) {
  ToolParameters shovel;
  Scene scene = sceneWith(rock(0.03), 0.125, shovel);
  scene.placeTool({{{Vec3(0, 0, 0.1), Quat::Identity()}, {}}});
  holdTool(scene, 0.5);
  const SavedScene saved = deserialiseSavedScene(serialise(scene.save()));
  Scene again(scene.bed().parameters(), shovel, saved);
  ASSERT_EQ(again.hash(), scene.hash());
  moveTool(scene, Vec3(0.01, 0, 0.11), 0.3);
  moveTool(again, Vec3(0.01, 0, 0.11), 0.3);
  EXPECT_EQ(again.hash(), scene.hash());
  EXPECT_EQ(again.soilWrench().force_n, scene.soilWrench().force_n);
  EXPECT_NE(scene.soilWrench().force_n.z(), 0);
}

}  // namespace
}  // namespace haptolith
