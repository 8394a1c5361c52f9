#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "haptolith/core/base64.h"
#include "haptolith/core/math/random.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/scene_file_keys.h"
#include "haptolith/scene_file/toml/toml_error.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/presets.h"

#include "../source_dir.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

SceneFile readAgain(const SceneFile& scene) {
  return loadSceneFileText(sceneFileText(scene), "again.toml");
}

void expectSameAgain(const SceneFile& scene, const std::string& what) {
  const SceneFile again = readAgain(scene);
  EXPECT_TRUE(again == scene) << what << ":\n" << sceneFileText(scene);
  EXPECT_EQ(sceneFileText(again), sceneFileText(scene)) << what;
}

SceneFile numbered(SceneFile scene, double radius_m) {
  scene.bed.soil = rescaled(scene.bed.soil, radius_m);
  return scene;
}

TEST(SceneFileText, GivesEverySceneThatIsShippedBack) {
  for (const fs::directory_entry& entry : fs::directory_iterator(sourceDir() / "scenes")) {
    if (entry.path().extension() == ".toml") {
      expectSameAgain(loadSceneFile(entry.path()), entry.path().filename().string());
    }
  }
}

TEST(SceneFileText, RefusesAToolThatOnlyTheLaboratoryHas) {
  for (const ToolShape shape : {ToolShape::kCone, ToolShape::kTube}) {
    SceneFile scene;
    scene.tool.shape = shape;
    EXPECT_THROW((void)sceneFileText(scene), InvalidParameter);
  }
}

TEST(SceneFileText, GivesThePapersSceneBackToTheNumbersThatWereWritten) {
  const std::string text = sceneFileText({});
  EXPECT_THAT(text, HasSubstr("title = \"The scene of the ICRA 2021 paper\"\n"));
  EXPECT_THAT(text, HasSubstr("\n[soil]\nradius_mm = 7\ngamma_nm = 4e-05\nrho0_kg_m3 = 1330\n"));
  EXPECT_THAT(text, HasSubstr("\nsize_mm = [50, 40, 5]\n"));
  EXPECT_THAT(text, HasSubstr("\n[names]\npreset = \"P3\"\nbody = \"Moon\"\n"));
  EXPECT_THAT(text, Not(HasSubstr("\nsurface_mm"))) << "it is measured";
}

TEST(SceneFileText, GivesEverySoilAtEveryRadiusBack) {
  for (const double radius_m : {7e-3, 3.5e-3, 1.1 * 1e-3, 13.7 * 1e-3}) {
    for (const Preset& preset : presets()) {
      SceneFile scene = numbered({}, radius_m);
      changePreset(scene, preset.name);
      expectSameAgain(scene, fmt::format("{} at {} m", preset.name, radius_m));
      EXPECT_EQ(readAgain(scene).preset, preset.name);
    }
    for (const std::string& name : soilNames()) {
      SceneFile scene = numbered({}, radius_m);
      changeSoil(scene, name);
      expectSameAgain(scene, fmt::format("{} at {} m", name, radius_m));
      EXPECT_EQ(readAgain(scene).soil_name, name);
    }
  }
}

TEST(SceneFileText, GivesGravityBackAfterAnyTurnAndAnyWorld) {
  std::mt19937_64 random(3);
  SceneFile scene;
  for (int turn = 0; turn < 100; ++turn) {
    scene.bed.gravity_m_s2 = Vec3(uniformSigned(random), uniformSigned(random), uniformSigned(random));
    changeBody(scene, bodies()[static_cast<std::size_t>(turn) % bodies().size()].name);
    expectSameAgain(scene, scene.body);
  }
  scene.bed.gravity_m_s2 = Vec3(-0.0, 0, 0);
  EXPECT_TRUE(std::signbit(readAgain(scene).bed.gravity_m_s2.x())) << "to the last bit";
  EXPECT_FALSE(std::signbit(readAgain(scene).bed.gravity_m_s2.y()));
}

TEST(SceneFileText, KeepsWhatNumbersWereCalledAndWhatHasNoName) {
  SceneFile scene;
  scene.bed.soil.mu_hat = 0.3;  // a slider: still called P3
  scene.body = "";
  expectSameAgain(scene, "a preset with another number");
  scene.preset = "";
  scene.title = "Quotes \" and ' and \\, é";
  expectSameAgain(scene, "numbers without a name");
  scene.soil_name = "my \"own\" soil";
  expectSameAgain(scene, "a soil of one's own");
}

// --- every key -------------------------------------------------------------------------------------------------------

bool onlyChooses(const SceneFileKey& key) {
  if ((key.table == "tool" && (key.name == "mesh" || key.name == "model")) || key.name == "grains") {
    return true;
  }
  constexpr std::array<std::string_view, 6> kChoices{"preset", "name", "file", "direction", "body", "magnitude_m_s2"};
  return (key.table == "soil" || key.table == "gravity") && std::ranges::find(kChoices, key.name) != kChoices.end();
}

TEST(SceneFileText, EveryKeyIsWrittenButThoseThatChooseWhatOthersWrite) {
  for (const SceneFileKey& key : sceneFileKeys()) {
    const bool written = std::visit([](const auto& value) { return value.get != nullptr; }, key.value);
    EXPECT_EQ(written, !onlyChooses(key)) << key.table << " " << key.name;
  }
}

double anyIn(const Range& range, std::mt19937_64& random) {
  const double low = std::max(range.lowest, -1e3);
  const double high = std::min(range.highest, 1e3);
  return low + (high - low) * (0.5 + 0.499 * uniformSigned(random));
}

/// A mesh of any size, as `mesh_data` has it.
std::string tetrahedronData(std::mt19937_64& random) {
  const double edge_mm = anyIn({10, 30}, random);
  return "obj:" +
         base64(fmt::format("v 0 0 0\nv {0} 0 0\nv 0 {0} 0\nv 0 0 {0}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", edge_mm));
}

/// Some other value than the default's, as TOML.
std::string someValue(const SceneFileKey& key, std::mt19937_64& random) {
  using Key = SceneFileKey;
  const auto some = [&](const auto& value) -> std::string {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, Key::NumberValue>) {
      return fmt::format("{}", anyIn(value.valid, random));
    } else if constexpr (std::is_same_v<Value, Key::CountValue>) {
      return fmt::format("{}", std::llround(anyIn(value.valid, random)));
    } else if constexpr (std::is_same_v<Value, Key::VectorValue>) {
      return fmt::format("[{}, {}, {}]", anyIn(value.valid, random), anyIn(value.valid, random),
                         anyIn(value.valid, random));
    } else if constexpr (std::is_same_v<Value, Key::IntervalValue>) {
      const double low = anyIn(value.valid, random);
      return fmt::format("[{}, {}]", low, std::max(low, anyIn(value.valid, random)));
    } else if constexpr (std::is_same_v<Value, Key::SwitchValue>) {
      return value.get(SceneFile{}) ? "false" : "true";
    } else if constexpr (std::is_same_v<Value, Key::WordValue>) {
      return fmt::format("'{}'", value.valid[random() % value.valid.size()]);
    } else if constexpr (std::is_same_v<Value, Key::TextValue>) {
      return fmt::format("'text {}'", random() % 1000);
    } else if constexpr (std::is_same_v<Value, Key::DataValue>) {
      return fmt::format("'{}'", tetrahedronData(random));
    } else {
      return "'moves.csv'";
    }
  };
  return std::visit(some, key.value);
}

/// As above, with consistent values: soil that carries its own weight, in a box that holds it.
std::string likelyValue(const SceneFileKey& key, std::mt19937_64& random) {
  const auto about = [&](double middle) { return fmt::format("{}", middle * (1 + 0.3 * uniformSigned(random))); };
  if (key.table == "soil" && key.name != "friction_model") {
    for (const auto& [name, middle] :
         {std::pair{"radius_mm", 7.0}, std::pair{"gamma_nm", 4e-5}, std::pair{"rho0_kg_m3", 1000.0},
          std::pair{"rho_max_kg_m3", 2500.0}, std::pair{"stiffness_n_m", 1000.0}}) {
      if (key.name == name) {
        return about(middle);
      }
    }
  }
  if (key.name == "vector_m_s2") {
    return fmt::format("[{}, {}, {}]", uniformSigned(random), uniformSigned(random), uniformSigned(random));
  }
  if (key.name == "fine_radius_mm") {
    return "0";  // only halves of the soil's are taken
  }
  if (key.table == "coupling" && key.name == "mass_kg") {
    return about(50);  // enough for a tick to follow any spring and damper
  }
  if (key.name == "mesh_unit_mm") {
    return about(1);  // such that a hand can hold it
  }
  if (key.table == "stones") {
    for (const auto& [name, middle] : {std::pair{"smallest_mm", 20.0}, std::pair{"largest_mm", 60.0},
                                       std::pair{"shallowest_mm", -10.0}, std::pair{"deepest_mm", 50.0}}) {
      if (key.name == name) {
        return about(middle);
      }
    }
    if (key.name == "count") {
      return "0";  // not every soil takes stones
    }
  }
  if (key.table == "bed" && key.name.ends_with("_mm")) {
    return about(100);
  }
  if (key.name == "particles" || key.name == "layers") {
    return fmt::format("{}", 2 + random() % 5);
  }
  return key.name == "motion" ? "'poses'" : someValue(key, random);
}

class SceneFileWithPoses : public testing::Test {
 protected:
  SceneFileWithPoses() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_scene_file_text_{}", getpid())) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "moves.csv") << "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
  }
  ~SceneFileWithPoses() override { fs::remove_all(folder_); }

  /// A scene with every key that can be written, at random.
  [[nodiscard]] std::string anyScene(std::mt19937_64& random) const {
    std::string text;
    std::string_view table;
    const bool with_mesh = random() % 20 == 0;  // which takes a while to be made
    for (const SceneFileKey& key : sceneFileKeys()) {
      if (onlyChooses(key) || (key.name == "mesh_data" && !with_mesh) || key.name == "grains_data") {
        continue;
      }
      if (key.table != table) {
        table = key.table;
        text += fmt::format("[{}]\n", table);
      }
      std::string value = likelyValue(key, random);
      if (key.name == "jaw_bend_deg" && text.find("shape = 'jaws'") != std::string::npos) {
        value = "0";  // not every grain fits into every curve
      }
      value = value == "'given'" ? "'packed'" : value;  // grains would have to lie in whatever box it is
      text += fmt::format("{} = {}\n", key.name, value == "'mesh'" && !with_mesh ? "'box'" : value);
    }
    return text;
  }

  fs::path folder_;
};

TEST_F(SceneFileWithPoses, GiveEveryKeyBackWhateverItIs) {
  std::mt19937_64 random(11);
  for (int round = 0; round < 200; ++round) {
    const std::string text = anyScene(random);
    const SceneFile scene = loadSceneFileText(text, (folder_ / "any.toml").string());
    ASSERT_TRUE(readAgain(scene) == scene) << text << "\nbecomes\n" << sceneFileText(scene);
    ASSERT_EQ(sceneFileText(readAgain(scene)), sceneFileText(scene));
  }
}

TEST(SceneFileText, GivesStonesBack) {
  const SceneFile scene = loadSceneFileText(R"(
[soil]
name = "lunar-0-15cm"
[bed]
start = "settled"
depth_mm = 60
[stones]
count = 7
shape = "sphere"
smallest_mm = 12.5
exponent = 1.8
fixed = true
[[stone]]
size_mm = 33.3
seed = 12
x_mm = -20
depth_mm = 31
turn_deg = [10, 20, -30]
[[stone]]
shape = "spheres"
spheres_mm = [0, 0, 0, 8, 0, 0.1, 12, 8]
y_mm = 20
fixed = true
)",
                                            "x");
  EXPECT_EQ(scene.bed.stones.count, 7);
  ASSERT_EQ(scene.bed.stones.placed.size(), 2U);
  EXPECT_NEAR(scene.bed.stones.placed[0].size_m, 33.3e-3, 1e-12);
  ASSERT_EQ(scene.bed.stones.placed[1].spheres.size(), 2U);
  EXPECT_EQ(scene.bed.stones.placed[1].spheres[1], (StoneSphere{Vec3(0, 0.1 * 1e-3, 12 * 1e-3), 8 * 1e-3}));
  expectSameAgain(scene, "stones");
}

TEST(SceneFileText, RefusesStonesThatCannotBeWithTheirLine) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      (void)sceneFileFromText("[soil]\nname = 'lunar-0-15cm'\n" + text, "x");
    } catch (const InvalidParameter& error) {
      return error.what();
    }
    return "taken";
  };
  EXPECT_EQ(refusal("[stones]\ncount = 2000\n"),
            "x:4: [stones] count = 2000 is not valid: must be a whole number, 0 to 1000");
  EXPECT_THAT(refusal("[stones]\ncount = 3\nsmallest_mm = 60\n"), HasSubstr("[stones] largest_mm"));
  EXPECT_THAT(refusal("[[stone]]\nsize_mm = 0\n"), HasSubstr("x:4: [[stone]] size_mm = 0"));
  EXPECT_THAT(refusal("[[stone]]\nshape = 'spheres'\n"), HasSubstr("spheres_mm"));
  EXPECT_THAT(refusal("[[stone]]\nshape = 'spheres'\nspheres_mm = [1, 2, 3]\n"),
              HasSubstr("x, y, z and radius of each sphere"));
  EXPECT_THAT(refusal("[[stone]]\nspheres_mm = [1, 2, 3, 4]\n"), HasSubstr("shape = spheres"));
  EXPECT_THAT(refusal("[[stone]]\ncolour = 1\n"), HasSubstr("colour"));
  EXPECT_THAT(refusal("stone = 3\n"), HasSubstr("stone"));
}

TEST_F(SceneFileWithPoses, DependOnNoFolder) {
  SceneFile scene;
  scene.hand.motion = HandMotion::kPoses;
  scene.hand.poses_file = fs::relative(folder_ / "moves.csv").string();
  EXPECT_TRUE(fs::path(readAgain(scene).hand.poses_file).is_absolute());
  EXPECT_TRUE(fs::equivalent(readAgain(scene).hand.poses_file, folder_ / "moves.csv"));

  scene.hand.motion = HandMotion::kStir;  // --motion stir, on top of a scene with poses
  EXPECT_EQ(readAgain(scene).hand.motion, HandMotion::kStir);
  EXPECT_EQ(readAgain(scene).hand.poses_file, "");
}

TEST_F(SceneFileWithPoses, AreRefusedWhenTheyHaveGone) {
  SceneFile scene;
  scene.hand.motion = HandMotion::kPoses;
  scene.hand.poses_file = (folder_ / "gone.csv").string();
  EXPECT_THAT([&] { (void)sceneFileText(scene); }, testing::ThrowsMessage<InvalidParameter>(HasSubstr("gone.csv")));
}

TEST(SceneFileText, RefusesWhatNoFileCanHold) {
  const auto with = [](auto change) {
    SceneFile scene;
    change(scene);
    return scene;
  };
  const auto without_mm = [] {  // the next length from 0.1 m on that no number of mm becomes
    double length_m = 0.1;
    double mm = 100;
    while (mm * 1e-3 == length_m) {
      mm = std::nextafter(mm, 1e3);
      length_m = std::nextafter(length_m, 1);
    }
    return length_m;
  };
  for (const SceneFile& scene :
       {with([](SceneFile& s) { s.bed.periodic_x = true; }),
        with([](SceneFile& s) { s.bed.tick_s = s.loop.tick_s = 5e-4; }),
        with([](SceneFile& s) { s.tool.cone_angle_rad = 0.5; }), with([](SceneFile& s) { s.title = ""; }),
        with([](SceneFile& s) { s.title = "two\nlines"; }),
        with([](SceneFile& s) { s.bed.soil.mu_hat = std::nan(""); }),
        with([](SceneFile& s) { s.bed.soil.stiffness_n_m = INFINITY; }),
        with([](SceneFile& s) { s.bed.seed = ~std::uint64_t{0}; }),
        with([&](SceneFile& s) { s.bed.width_m = without_mm(); })}) {
    EXPECT_THROW((void)sceneFileText(scene), InvalidParameter) << scene.title;
  }
}

TEST(LoadSceneFileText, RefusesAsAFileDoesAndCallsItByItsName) {
  EXPECT_THAT(
      [] { (void)loadSceneFileText("[soil]\nmu_hat = -1\n", "scene of a recording"); },
      testing::ThrowsMessage<TomlError>("scene of a recording:2: [soil] mu_hat = -1 is not valid: must be 0 to 10"));
  EXPECT_THROW((void)loadSceneFileText("", "nothing"), TomlError);
  EXPECT_THAT([] { (void)loadSceneFileText("[gravity]\nvector_m_s2 = [0, 0, -1]\nbody = 'Moon'\n", "x"); },
              testing::ThrowsMessage<TomlError>(HasSubstr("vector_m_s2 and body cannot both be given")));
}

}  // namespace
}  // namespace haptolith
