// The scene `auto`: settled soil of each radius that it may open with ships with the program.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "haptolith/bed/start/ready_tile.h"
#include "haptolith/bed/start/tile_cache.h"
#include "haptolith/core/error.h"
#include "haptolith/scene/scene.h"
#include "haptolith/scene_file/scene_file.h"

#include "../bed/every_target.h"

namespace haptolith {
namespace {

SceneFile autoWith(double radius_m) {
  SceneFile scene_file = findSceneFile("auto");
  scene_file.bed.soil = rescaled(scene_file.bed.soil, radius_m);
  return scene_file;
}

TEST(AutoScene, SoilOfEachRadiusShipsWithTheProgram) {
  for (const double radius_m : kGrainRadii_m) {
    const BedParameters bed = autoWith(radius_m).bed;
    const std::optional<BedTile> tile = readyTile(bed);
    ASSERT_TRUE(tile) << readyTileName(bed) << " is missing: run ./dev tiles";
    EXPECT_GT(tile->grains.size(), 500U);
    EXPECT_EQ(tile->floor_slips.size(), tile->grains.size());
  }
  EXPECT_FALSE(readyTile(autoWith(3.3e-3).bed)) << "no step of the ladder";
}

using AutoSceneOnEveryTarget = EveryTarget;

TEST_F(AutoSceneOnEveryTarget, LiesStillUntilItIsTouched) {
  for (const double radius_m : {7e-3, 4.4e-3, 2.9e-3}) {
    SceneFile scene_file = autoWith(radius_m);
    forEachTarget([&] {
      Scene scene(scene_file.bed, scene_file.tool);
      HandState above;
      above.pose.position_m = Vec3(0, 0, scene.bed().surfaceHeight() + 0.1);
      scene.placeTool(above);
      for (int tick = 0; tick < 100; ++tick) {
        ASSERT_EQ(scene.tick(above), StepStatus::kOk);
        ASSERT_EQ(scene.bed().awake(), 0U) << radius_m << " m in tick " << tick;
      }
    });
  }
}

TEST_F(AutoSceneOnEveryTarget, IsAtRestThoughNothingMaySleep) {
  SceneFile scene_file = autoWith(4.4e-3);
  scene_file.bed.sleep = false;
  forEachTarget([&] {
    Scene scene(scene_file.bed, scene_file.tool);
    HandState above;
    above.pose.position_m = Vec3(0, 0, scene.bed().surfaceHeight() + 0.1);
    scene.placeTool(above);
    for (int tick = 0; tick < 100; ++tick) {
      ASSERT_EQ(scene.tick(above), StepStatus::kOk);
    }
    EXPECT_LT(scene.bed().largestSpeed(), 1e-3);
  });
}

TEST(AutoScene, BecomesCoarserStepByStep) {
  SceneFile scene_file = findSceneFile("auto");
  int steps = 0;
  for (double before_m = scene_file.bed.soil.radius_m; canBeCoarser(scene_file);
       before_m = scene_file.bed.soil.radius_m) {
    makeCoarser(scene_file);
    EXPECT_GT(scene_file.bed.soil.radius_m, 1.04 * before_m);
    EXPECT_LT(scene_file.bed.soil.radius_m, 1.15 * before_m);
    EXPECT_TRUE(readyTile(scene_file.bed));
    ++steps;
  }
  EXPECT_EQ(steps, 5);
  EXPECT_DOUBLE_EQ(scene_file.bed.soil.radius_m, kGrainRadii_m.front());
  EXPECT_THROW(makeCoarser(scene_file), InvalidParameter);
  EXPECT_FALSE(canBeCoarser(findSceneFile("icra2021"))) << "its particles are counted";
  EXPECT_TRUE(canBeCoarser(findSceneFile("regolith")));
}

TEST(AutoScene, IsTheSameWhenReadFromItsText) {
  const SceneFile scene_file = autoWith(4e-3);
  const SceneFile read = loadSceneFileText(sceneFileText(scene_file), "stored");
  EXPECT_TRUE(read.bed.ready_made);
  EXPECT_EQ(readyTileName(read.bed), readyTileName(scene_file.bed));
  EXPECT_TRUE(readyTile(read.bed));
}

}  // namespace
}  // namespace haptolith
