#include "haptolith/session/scene_change.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "haptolith/core/error.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

TEST(SceneChange, ChangesWhatItNamesAndNothingElse) {
  SceneChange change;
  change.preset = "P1";
  change.body = "Mars";
  change.tool_shape = ToolShape::kSphere;
  change.tool_diameter_m = 0.02;
  change.tool_opening_m = 0.03;
  const SceneFile next = changed(SceneFile{}, change);
  EXPECT_EQ(next.preset, "P1");
  EXPECT_EQ(next.bed.soil, findPreset("P1").soil);
  EXPECT_EQ(next.bed.gravity_m_s2, Vec3(0, 0, -3.721));
  EXPECT_EQ(next.body, "Mars");
  EXPECT_EQ(next.tool.shape, ToolShape::kSphere);
  EXPECT_EQ(next.tool.diameter_m, 0.02);
  EXPECT_EQ(next.tool.opening_m, 0.03);
  EXPECT_EQ(next.tool.size_m, ToolParameters{}.size_m);
  EXPECT_EQ(next.bed.width_m, BedParameters{}.width_m);
}

TEST(SceneChange, ASoilWithANameReplacesAPreset) {
  SceneChange change;
  change.soil = "dry-sand";
  const SceneFile next = changed(SceneFile{}, change);
  EXPECT_EQ(next.soil_name, "dry-sand");
  EXPECT_TRUE(next.preset.empty());
  EXPECT_EQ(next.bed.soil.friction, FrictionModel::kContact);
  EXPECT_EQ(next.bed.soil.radius_m, SceneFile{}.bed.soil.radius_m);
}

TEST(SceneChange, TheTitleNamesWhatIsThereOnceThatHasChanged) {
  SceneChange change;
  EXPECT_EQ(changed(SceneFile{}, change).title, SceneFile{}.title);
  change.soil = "dry-sand";
  change.body = "Earth";
  SceneFile next = changed(SceneFile{}, change);
  EXPECT_EQ(next.title, "dry-sand soil, Earth, R = 7 mm, shovel, scoop");
  change = {};
  change.preset = "P1";
  change.gravity_m_s2 = 5;
  next = changed(next, change);
  EXPECT_EQ(next.title, "P1 soil, 5 m/s2, R = 7 mm, shovel, scoop");
  change = {};
  change.tool_shape = ToolShape::kSphere;
  EXPECT_EQ(changed(next, change).title, "P1 soil, 5 m/s2, R = 7 mm, sphere, scoop");
  next.title = "mine";
  change = {};
  change.preset = "P1";
  EXPECT_EQ(changed(next, change).title, "mine") << "it is the same soil";
}

TEST(SceneChange, WhatCannotBeIsRefused) {
  const auto refused = [](auto set) {
    SceneChange change;
    set(change);
    EXPECT_THROW((void)changed(SceneFile{}, change), InvalidParameter);
  };
  refused([](SceneChange& c) { c.preset = "P7"; });
  refused([](SceneChange& c) { c.body = "Venus"; });
  refused([](SceneChange& c) { c.preset = "P1", c.soil = "dry-sand"; });
  refused([](SceneChange& c) { c.sliders = {{"friction_angle_deg", 89}}; });
  refused([](SceneChange& c) { c.tool_size_m = Vec3(0, 1, 1); });
}

/// Settled soil with a sphere in it.
SceneFile ballInSoil() {
  SceneFile scene = findSceneFile("buried-stone");
  scene.bed.stones.placed.push_back(scene.bed.stones.placed.front());
  return scene;
}

TEST(SceneChange, ChangesTheDepthOfSoilItsStonesAndGravity) {
  SceneChange change;
  change.soil_depth_m = 0.06;
  change.stone_size_m = 0.02;
  change.stone_depth_m = 0.04;
  change.gravity_m_s2 = 5;
  const SceneFile next = changed(ballInSoil(), change);
  EXPECT_EQ(next.bed.depth_m, 0.06);
  ASSERT_EQ(next.bed.stones.placed.size(), 2U);
  for (const PlacedStone& stone : next.bed.stones.placed) {
    EXPECT_EQ(stone.size_m, 0.02);
    EXPECT_EQ(stone.depth_m, 0.04);
    EXPECT_TRUE(stone.fixed);
  }
  EXPECT_EQ(next.bed.gravity_m_s2, Vec3(0, 0, -5));
  EXPECT_TRUE(next.body.empty());
  EXPECT_EQ(next.bed.soil, ballInSoil().bed.soil);
  EXPECT_TRUE(change.wantsNewBed());
}

TEST(SceneChange, GravityKeepsItsDirectionAndFallsDownFromNothing) {
  SceneFile scene;
  scene.bed.gravity_m_s2 = Vec3(3, 0, -4);
  SceneChange change;
  change.gravity_m_s2 = 10;
  EXPECT_TRUE(changed(scene, change).bed.gravity_m_s2.isApprox(Vec3(6, 0, -8)));
  scene.bed.gravity_m_s2 = Vec3::Zero();
  EXPECT_EQ(changed(scene, change).bed.gravity_m_s2, Vec3(0, 0, -10));
  EXPECT_FALSE(change.wantsNewBed());
}

TEST(SceneChange, WhatABedOrAStoneCannotBeIsRefusedWithItsValue) {
  const auto refused = [](const SceneFile& scene, auto set, const std::string& value, const std::string& valid) {
    SceneChange change;
    set(change);
    EXPECT_THAT([&] { (void)changed(scene, change); }, testing::ThrowsMessage<InvalidParameter>(testing::AllOf(
                                                           testing::HasSubstr(value), testing::HasSubstr(valid))));
  };
  refused(
      SceneFile{}, [](SceneChange& c) { c.soil_depth_m = 0.05; }, "soil_depth_mm = 50", "`packed` or `settled`");
  refused(
      SceneFile{}, [](SceneChange& c) { c.stone_depth_m = 0.05; }, "stone_depth_mm = 50", "no [[stone]]");
  refused(
      SceneFile{}, [](SceneChange& c) { c.stone_size_m = 0.05; }, "stone_size_mm = 50", "no [[stone]]");
  refused(
      findSceneFile("firm-ground"), [](SceneChange& c) { c.stone_size_m = 0.05; }, "stone_size_mm = 50",
      "size of its spheres");
  refused(
      ballInSoil(), [](SceneChange& c) { c.stone_size_m = 0.0005; }, "stone_size_mm = 0.5", "1 to 10000");
  refused(
      ballInSoil(), [](SceneChange& c) { c.stone_depth_m = 200; }, "stone_depth_mm = 200000", "-10000 to 100000");
  refused(
      ballInSoil(), [](SceneChange& c) { c.soil_depth_m = 0.001; }, "1", "");
  refused(
      SceneFile{}, [](SceneChange& c) { c.gravity_m_s2 = -1; }, "gravity_m_s2 = -1", "0 to 1000");
}

TEST(SceneChange, NoToolBecomesLargerThanTheBox) {
  const auto refused = [](auto set) {
    SceneChange change;
    set(change);
    EXPECT_THAT([&] { (void)changed(SceneFile{}, change); },
                testing::ThrowsMessage<InvalidParameter>(
                    testing::AllOf(testing::HasSubstr("_mm = 127"), testing::HasSubstr("1 to 126"))));
  };
  refused([](SceneChange& c) { c.tool_size_m = Vec3(0.127, 0.05, 0.05); });
  refused([](SceneChange& c) { c.tool_size_m = Vec3(0.05, 0.127, 0.05); });
  refused([](SceneChange& c) { c.tool_size_m = Vec3(0.05, 0.05, 0.127); });
  refused([](SceneChange& c) { c.tool_diameter_m = 0.127; });
  refused([](SceneChange& c) { c.tool_thickness_m = 0.127; });
  refused([](SceneChange& c) { c.tool_opening_m = 0.127; });
  SceneChange largest;
  largest.tool_size_m = Vec3::Constant(SceneFile{}.bed.width_m);
  EXPECT_EQ(changed(SceneFile{}, largest).tool.size_m, largest.tool_size_m);

  SceneFile long_box;
  long_box.bed.length_m = 0.5;
  EXPECT_EQ(toolLengths(long_box.bed).highest, long_box.bed.width_m) << "the tool can be turned";
}

TEST(SceneChange, OnlyOtherSoilWantsANewBed) {
  SceneChange change;
  change.body = "Mars";
  change.sliders = {{"friction_angle_deg", 30}};
  EXPECT_FALSE(change.wantsNewBed());
  change.friction = FrictionModel::kIcra2021;
  EXPECT_TRUE(change.wantsNewBed());
}

}  // namespace
}  // namespace haptolith
