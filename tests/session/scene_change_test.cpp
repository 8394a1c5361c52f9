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
  const Scenario next = changed(Scenario{}, change);
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
  const Scenario next = changed(Scenario{}, change);
  EXPECT_EQ(next.soil_name, "dry-sand");
  EXPECT_TRUE(next.preset.empty());
  EXPECT_EQ(next.bed.soil.friction, FrictionModel::kContact);
  EXPECT_EQ(next.bed.soil.radius_m, Scenario{}.bed.soil.radius_m);
}

TEST(SceneChange, WhatCannotBeIsRefused) {
  const auto refused = [](auto set) {
    SceneChange change;
    set(change);
    EXPECT_THROW((void)changed(Scenario{}, change), InvalidParameter);
  };
  refused([](SceneChange& c) { c.preset = "P7"; });
  refused([](SceneChange& c) { c.body = "Venus"; });
  refused([](SceneChange& c) { c.preset = "P1", c.soil = "dry-sand"; });
  refused([](SceneChange& c) { c.sliders = {{"friction_angle_deg", 89}}; });
  refused([](SceneChange& c) { c.tool_size_m = Vec3(0, 1, 1); });
}

TEST(SceneChange, NoToolBecomesLargerThanTheBox) {
  const auto refused = [](auto set) {
    SceneChange change;
    set(change);
    EXPECT_THAT([&] { (void)changed(Scenario{}, change); },
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
  largest.tool_size_m = Vec3::Constant(Scenario{}.bed.width_m);
  EXPECT_EQ(changed(Scenario{}, largest).tool.size_m, largest.tool_size_m);

  Scenario long_box;
  long_box.bed.length_m = 0.5;
  EXPECT_EQ(toolLengths(long_box.bed).highest, long_box.bed.width_m) << "the tool can be turned";
}

TEST(SceneChange, OnlyOtherSoilWantsANewBed) {
  SceneChange change;
  change.body = "Mars";
  change.sliders = {{"friction_angle_deg", 30}};
  EXPECT_FALSE(change.wantsNewBed());
  change.friction = FrictionModel::kPaper;
  EXPECT_TRUE(change.wantsNewBed());
}

}  // namespace
}  // namespace haptolith
