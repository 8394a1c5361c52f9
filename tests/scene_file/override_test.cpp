#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
using Texts = std::vector<std::string>;

SceneFile with(const std::string& text, const Texts& overrides) {
  return sceneFileFromText(text, "mine.toml", overrides);
}

TEST(Overrides, ReplaceWhatTheFileSays) {
  const SceneFile scene = with("title = 'x'\n[bed]\nseed = 3\nparticles = 200\n",
                               {"bed.seed=7", " tool.shape = sphere ", "tool.size_mm=[1, 2, 3]", "tool.diameter_mm=40",
                                "loop.real_time=false", "title=my own \"scene\""});
  EXPECT_EQ(scene.bed.seed, 7U);
  EXPECT_EQ(scene.bed.particles, 200);
  EXPECT_EQ(scene.tool.shape, ToolShape::kSphere);
  EXPECT_DOUBLE_EQ(scene.tool.diameter_m, 0.04);
  EXPECT_FALSE(scene.loop.real_time);
  EXPECT_EQ(scene.title, "my own \"scene\"");
}

TEST(Overrides, TakeTheFilesRivalsWithThem) {
  const std::string file = "[soil]\npreset = 'P2'\nradius_mm = 5\n[gravity]\nbody = 'Mars'\n";
  const SceneFile named = with(file, {"soil.name=dry-sand", "gravity.magnitude_m_s2=3"});
  EXPECT_EQ(named.soil_name, "dry-sand");
  EXPECT_EQ(named.preset, "");
  EXPECT_DOUBLE_EQ(named.bed.soil.radius_m, 5e-3);
  EXPECT_DOUBLE_EQ(named.bed.gravity_m_s2.norm(), 3);
  EXPECT_THAT(
      [&] {
        (void)with(file, {"soil.name=dry-sand", "soil.preset=P1"});
      },
      testing::ThrowsMessage<InvalidParameter>(HasSubstr("cannot both be given")));
}

TEST(Overrides, ANamedSoilIsThatSoilWithItsOwnFrictionAsWithTheOptionSoil) {
  const SceneFile named = findSceneFile("icra2021", Texts{"soil.name=dry-sand"});
  SceneFile by_option = findSceneFile("icra2021");
  changeSoil(by_option, "dry-sand");
  EXPECT_EQ(named.bed.soil, by_option.bed.soil);
  EXPECT_EQ(named.bed.soil.friction, FrictionModel::kContact) << "the scene icra2021 says icra2021";
  EXPECT_EQ(named.bed.start, by_option.bed.start) << "no crystal";
  SceneFile by_preset = findSceneFile("icra2021");
  changePreset(by_preset, "P1");
  EXPECT_EQ(findSceneFile("icra2021", Texts{"soil.preset=P1"}).bed.soil, by_preset.bed.soil);
  const SceneFile own =
      findSceneFile("icra2021", Texts{"soil.name=dry-sand", "soil.friction_model=icra2021", "bed.start=packed"});
  EXPECT_EQ(own.bed.soil.friction, FrictionModel::kIcra2021);
  EXPECT_EQ(own.bed.start, BedStart::kPacked);
}

TEST(Overrides, ReplaceATitleThatMayNameWhatTheyChange) {
  const auto titled = [](const Texts& overrides) { return findSceneFile("europa", overrides).title; };
  const std::string own = findSceneFile("europa").title;
  EXPECT_EQ(titled({"bed.seed=3"}), own);
  EXPECT_EQ(titled({"soil.preset=P4"}), own) << "it is the same soil";
  EXPECT_EQ(titled({"soil.preset=P1"}), "P1 soil, Europa, R = 7 mm, shovel, carry");
  EXPECT_EQ(titled({"gravity.body=Moon"}), "P4 soil, Moon, R = 7 mm, shovel, carry");
  EXPECT_EQ(titled({"gravity.magnitude_m_s2=3", "soil.name=dry-sand"}),
            "dry-sand soil, 3 m/s2, R = 7 mm, shovel, carry");
  EXPECT_EQ(titled({"tool.model=scoop"}), "P4 soil, Europa, R = 7 mm, scoop, carry");
  EXPECT_EQ(titled({"tool.shape=plate", "hand.motion=still"}), "P4 soil, Europa, R = 7 mm, plate");
  EXPECT_EQ(titled({"soil.preset=P1", "title=mine"}), "mine");
  SceneFile scene = findSceneFile("europa", Texts{"soil.preset=P1"});
  changeBody(scene, "Mars");
  EXPECT_EQ(scene.title, "P1 soil, Mars, R = 7 mm, shovel, carry");
  EXPECT_EQ(findSceneFile("stones", Texts{"soil.radius_mm=6"}).title,
            "lunar-0-15cm soil, Moon, R = 6 mm, stones, shovel, stir");
}

TEST(Overrides, ShowWhatLooksLikeNothingInAValue) {
  EXPECT_THAT([] { (void)with("title = 'x'", {"soil.radius_mm=0.5\u00a0"}); },
              testing::ThrowsMessage<InvalidParameter>(HasSubstr(R"('0.5\u00a0' is not valid: must be a number)")));
}

TEST(Overrides, SayWhichOfThemIsWrong) {
  const auto message = [](const Texts& overrides) {
    try {
      (void)with("[bed]\nseed = 1\n", overrides);
    } catch (const InvalidParameter& error) {
      return std::string(error.what());
    }
    return std::string("nothing was wrong");
  };
  EXPECT_EQ(message({"bed.threads=900"}),
            "override bed.threads=900: [bed] threads = 900 is not valid: must be a whole number, 1 to 256");
  EXPECT_THAT(message({"bed.seed=1\n[tool]"}), HasSubstr("[bed] seed = "));
  EXPECT_THAT(message({"bed=3"}), HasSubstr("must be a table"));
  EXPECT_THAT(message({"bed.seed"}), HasSubstr("table.key=value"));
  EXPECT_THAT(message({"Bed.seed=1"}), HasSubstr("table.key=value"));
  EXPECT_THAT(message({"a.b.c=1"}), HasSubstr("table.key=value"));
  EXPECT_THAT(message({"soil.colour=red"}), HasSubstr("override soil.colour=red: [soil] colour is not known"));
  EXPECT_THAT(message({"rain.count=3"}), testing::StartsWith("override rain.count=3: [rain] is not known"));
  EXPECT_THAT(message({"soil.file=no-such.toml"}), HasSubstr("no such file"));
  EXPECT_THAT(message({"soil.file=" + std::string(300, 'x')}), HasSubstr("no such file")) << "nor can be";
  EXPECT_THAT(message({"device.library=/tmp/x.so"}), HasSubstr("cannot name libraries"));
  EXPECT_THAT(message({"title=\xff\xfe"}), HasSubstr("UTF-8"));
  EXPECT_THAT(message({"bed.depth_mm=60"}), HasSubstr("has no effect"));
}

TEST(Overrides, WithoutEffectIsToldOfThemAndNotOfTheFilesKeysThatTheyReplace) {
  const Texts overrides{"soil.name=dry-sand", "tool.shape=sphere", "tool.size_mm=[10, 10, 10]"};
  const auto idle = idleKeys("icra2021", findSceneFile("icra2021", overrides), overrides);
  EXPECT_THAT(idle, testing::ElementsAre(
                        testing::StartsWith("override tool.size_mm=[10, 10, 10]: [tool] size_mm has no effect")));
}

TEST(Overrides, CarryKeyValueAndRangeApart) {
  try {
    (void)with("", {"soil.mu_hat=-1"});
    FAIL();
  } catch (const InvalidParameter& error) {
    EXPECT_EQ(error.key(), "soil.mu_hat");
    EXPECT_EQ(error.value(), "-1");
    EXPECT_THAT(error.valid(), HasSubstr("0"));
  }
}

TEST(Changed, KeepsTheSizeOfTheGrainsThatLieThere) {
  SceneFile scene;
  scene.bed.soil = rescaled(scene.bed.soil, 4e-3);
  const SceneFile other = changed(scene, Texts{"soil.preset=P1"});
  EXPECT_EQ(other.preset, "P1");
  EXPECT_DOUBLE_EQ(other.bed.soil.radius_m, 4e-3);
  EXPECT_EQ(other.bed.soil.mu_hat, findPreset("P1").soil.mu_hat);
  EXPECT_DOUBLE_EQ(changed(scene, Texts{"soil.preset=P1", "soil.radius_mm=6"}).bed.soil.radius_m, 6e-3);
  EXPECT_EQ(changed(scene, Texts{}), scene);
}

}  // namespace
}  // namespace haptolith
