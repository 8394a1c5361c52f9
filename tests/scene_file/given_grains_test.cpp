#include "haptolith/scene_file/given_grains.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/scene_file/scene_file.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kSoil = "[soil]\nfriction_model = 'contact'\nsize_spread = 0.1\n";

class GrainsInAScene : public testing::Test {
 protected:
  GrainsInAScene() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_grains_{}", getpid())) {
    fs::create_directories(folder_);
    write("bed.csv",
          "id,z_m,y_m,x_m,radius_m,held\n1,0.007,0.01,0.02,0.0075,0\n2,0.006,0,-0.07,0.0065,1\n"
          "3,0.007,-0.01,0,0.007,0\n");
    write("free.csv", "x_m,y_m,z_m,radius_m\n# nobody is held\n0,0,0.007,0.007\n");
  }
  ~GrainsInAScene() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  [[nodiscard]] SceneFile sceneOf(const std::string& bed) const {
    return sceneFileFromText(kSoil + ("[bed]\n" + bed), (folder_ / "x.toml").string());
  }
  [[nodiscard]] std::string errorOf(const std::string& bed) const {
    try {
      (void)sceneOf(bed);
    } catch (const InvalidParameter& error) {
      return error.what();
    }
    return "nothing";
  }

  fs::path folder_;
};

TEST_F(GrainsInAScene, AreReadByTheNamesOfTheirColumns) {
  const SceneFile scene = sceneOf("grains = 'bed.csv'\n");
  EXPECT_EQ(scene.bed.start, BedStart::kGiven);
  const GivenGrains& given = scene.bed.given;
  ASSERT_EQ(given.count(), 3U);
  EXPECT_EQ(given.held, 1U);
  EXPECT_EQ(given.name, "bed.csv");
  EXPECT_EQ((*given.grains)[0], (std::array{0.02F, 0.01F, 0.007F, 0.0005F}));
  EXPECT_EQ((*given.grains)[2][0], -0.07F) << "what is held comes last";
  EXPECT_EQ(sceneOf("start = 'given'\ngrains = 'free.csv'\n").bed.given.held, 0U);
}

TEST_F(GrainsInAScene, TravelWithTheirText) {
  const SceneFile scene = sceneOf("grains = 'bed.csv'\n");
  const std::string text = sceneFileText(scene);
  fs::remove(folder_ / "bed.csv");
  const SceneFile again = loadSceneFileText(text, "the recorded scene");
  EXPECT_TRUE(again == scene);
  EXPECT_EQ(again.bed.given.held, 1U);
}

TEST_F(GrainsInAScene, AreNamedInAFileForPeople) {
  const SceneFile scene = sceneOf("start = 'settled'\ndepth_mm = 80\nwidth_mm = 150\n");
  write("y.toml", sceneFileTextWithGrains(scene, "bed.csv"));
  const SceneFile again = loadSceneFile(folder_ / "y.toml");  // which refuses keys without effect
  EXPECT_EQ(again.bed.start, BedStart::kGiven);
  EXPECT_EQ(again.bed.given.count(), 3U);
  EXPECT_DOUBLE_EQ(again.bed.width_m, 0.15);
  EXPECT_EQ(again.bed.soil.contact_friction, scene.bed.soil.contact_friction);
  EXPECT_THAT(idleKeys((folder_ / "y.toml").string(), again), testing::IsEmpty()) << "nothing to warn of";
}

TEST_F(GrainsInAScene, AreRefusedWithTheirLine) {
  write("short.csv", "x_m,y_m,z_m\n0,0,0.01\n");
  write("word.csv", "x_m,y_m,z_m,radius_m\n0,0,high,0.007\n");
  write("large.csv", "x_m,y_m,z_m,radius_m\n0,0,0.01,0.009\n");
  write("none.csv", "x_m,y_m,z_m,radius_m\n");
  EXPECT_THAT(errorOf("grains = 'gone.csv'\n"), HasSubstr("no such file"));
  EXPECT_THAT(errorOf("grains = 'short.csv'\n"), HasSubstr("radius_m"));
  EXPECT_THAT(errorOf("grains = 'word.csv'\n"), HasSubstr("word.csv:2"));
  EXPECT_THAT(errorOf("grains = 'large.csv'\n"), HasSubstr("0.0063 to 0.0077"));
  EXPECT_THAT(errorOf("grains = 'none.csv'\n"), HasSubstr("grains"));
  EXPECT_THAT(errorOf("start = 'given'\n"), HasSubstr("needs [bed] grains"));
  EXPECT_THAT(errorOf("start = 'packed'\ngrains = 'bed.csv'\n"), HasSubstr("cannot both be given"));
  EXPECT_THAT(errorOf("grains = 'bed.csv'\ndepth_mm = 50\n"), HasSubstr("depth_mm has no effect"));
  EXPECT_THAT(errorOf("grains_data = '1:AAAA'\n"), HasSubstr("the number of held particles"));
  EXPECT_THAT(errorOf("grains_data = 'AAAA'\n"), HasSubstr("the number of held particles"));
}

}  // namespace
}  // namespace haptolith
