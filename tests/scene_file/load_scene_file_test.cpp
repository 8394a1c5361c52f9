#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/toml/toml_error.h"

#include "../source_dir.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class LoadSceneFile : public testing::Test {
 protected:
  LoadSceneFile() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_scene_file_{}", getpid())) {
    fs::create_directories(folder_);
  }
  ~LoadSceneFile() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path write(const std::string& text) const {
    fs::path path = folder_ / "x.toml";
    std::ofstream(path) << text;
    return path;
  }

  [[nodiscard]] SceneFile load(const std::string& text) const { return loadSceneFile(write(text)); }

  /// The message, its folder cut off: "x.toml:2: ..."; checks that the error knows that line.
  [[nodiscard]] std::string errorOf(const std::string& text) const {
    try {
      (void)load(text);
    } catch (const TomlError& error) {
      const std::string message = std::string(error.what()).substr(folder_.string().size() + 1);
      if (error.line() > 0) {
        EXPECT_THAT(message, HasSubstr(fmt::format("x.toml:{}: ", error.line())));
      }
      return message;
    }
    return "no error";
  }

  fs::path folder_;
};

// --- what comes from strangers ---

TEST_F(LoadSceneFile, AFileNamesNoLibrary) {
  const std::string error = errorOf("[device]\nkind = 'force-dimension'\nlibrary = 'evil.so'\n");
  EXPECT_THAT(error, HasSubstr("x.toml:3: [device] library = 'evil.so' is not valid"));
  EXPECT_THAT(error, HasSubstr("--device-library PATH"));
  EXPECT_THAT(error, HasSubstr("FORCEDIM_SDK"));
}

TEST_F(LoadSceneFile, ALibraryThatAnOldRecordingHoldsIsPassedOver) {
  const SceneFile scene = loadSceneFileText("[device]\nkind = 'force-dimension'\nlibrary = '/tmp/evil.so'\n", "old");
  EXPECT_EQ(scene.device.kind, DeviceKind::kForceDimension);
  EXPECT_EQ(scene.device.library, "");
}

TEST_F(LoadSceneFile, ALibraryOfTheCommandLineIsNotStored) {
  SceneFile scene;
  scene.device.library = "/opt/sdk";
  EXPECT_THAT(sceneFileText(scene), testing::Not(HasSubstr("/opt/sdk")));
}

TEST_F(LoadSceneFile, ATitleIsALineThatCanBeShown) {
  EXPECT_THAT(
      errorOf("title = \"A nice scene\\nsystem('id')\"\n"),
      testing::AllOf(HasSubstr("x.toml:1: title = "), HasSubstr("text on one line without control characters")));
  EXPECT_THAT(errorOf("title = \"\\u001b]0;pwned\\u0007\"\n"), HasSubstr("without control characters"));
  EXPECT_EQ(load("title = '" + std::string(200, 'x') + "'\n").title.size(), 200U);
  const std::string error = errorOf("title = '" + std::string(1'000'000, 'x') + "'\n");
  EXPECT_THAT(error, HasSubstr("at most 200 bytes long, not 1000000"));
  EXPECT_LT(error.size(), 300U);
}

// --- what is read ---

TEST_F(LoadSceneFile, ShippedScenesAreValid) {
  int scenes = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(sourceDir() / "scenes")) {
    if (entry.path().extension() == ".toml") {
      EXPECT_NO_THROW((void)loadSceneFile(entry.path())) << entry.path();
      ++scenes;
    }
  }
  EXPECT_GE(scenes, 4);
}

TEST_F(LoadSceneFile, ThePapersSceneIsTheDefault) {
  const SceneFile icra2021 = loadSceneFile(sourceDir() / "scenes/icra2021.toml");
  const SceneFile preset;
  EXPECT_EQ(icra2021.title, preset.title);
  EXPECT_EQ(icra2021.preset, preset.preset);
  EXPECT_EQ(icra2021.body, preset.body);
  EXPECT_DOUBLE_EQ(icra2021.bed.soil.radius_m, preset.bed.soil.radius_m);
  EXPECT_DOUBLE_EQ(icra2021.bed.soil.gamma_nm, preset.bed.soil.gamma_nm);
  EXPECT_DOUBLE_EQ(icra2021.bed.soil.rho0_kg_m3, preset.bed.soil.rho0_kg_m3);
  EXPECT_DOUBLE_EQ(icra2021.bed.soil.rho_max_kg_m3, preset.bed.soil.rho_max_kg_m3);
  EXPECT_DOUBLE_EQ(icra2021.bed.soil.mu_hat, preset.bed.soil.mu_hat);
  EXPECT_DOUBLE_EQ(icra2021.bed.soil.stiffness_n_m, preset.bed.soil.stiffness_n_m);
  EXPECT_DOUBLE_EQ(icra2021.bed.soil.attraction_ratio, preset.bed.soil.attraction_ratio);
  EXPECT_DOUBLE_EQ(icra2021.bed.soil.moving_friction_ratio, preset.bed.soil.moving_friction_ratio);
  EXPECT_EQ(icra2021.bed.soil.friction, preset.bed.soil.friction);
  EXPECT_DOUBLE_EQ(icra2021.bed.soil.contact_friction, preset.bed.soil.contact_friction);
  EXPECT_DOUBLE_EQ(icra2021.bed.soil.contact_cohesion_n, preset.bed.soil.contact_cohesion_n);
  EXPECT_DOUBLE_EQ(icra2021.bed.soil.cohesion_range_ratio, preset.bed.soil.cohesion_range_ratio);
  EXPECT_DOUBLE_EQ(icra2021.bed.soil.tangential_ratio, preset.bed.soil.tangential_ratio);
  EXPECT_DOUBLE_EQ(icra2021.bed.soil.damping_ratio, preset.bed.soil.damping_ratio);
  EXPECT_TRUE(icra2021.bed.gravity_m_s2.isApprox(preset.bed.gravity_m_s2));
  EXPECT_EQ(icra2021.bed.start, preset.bed.start);
  EXPECT_EQ(icra2021.bed.particles, preset.bed.particles);
  EXPECT_EQ(icra2021.bed.layers, preset.bed.layers);
  EXPECT_DOUBLE_EQ(icra2021.bed.width_m, preset.bed.width_m);
  EXPECT_DOUBLE_EQ(icra2021.bed.length_m, preset.bed.length_m);
  EXPECT_DOUBLE_EQ(icra2021.bed.depth_m, preset.bed.depth_m);
  EXPECT_EQ(icra2021.bed.seed, preset.bed.seed);
  EXPECT_EQ(icra2021.bed.threads, preset.bed.threads);
  EXPECT_EQ(icra2021.bed.sleep, preset.bed.sleep);
  EXPECT_DOUBLE_EQ(icra2021.bed.sleep_speed_m_s, preset.bed.sleep_speed_m_s);
  EXPECT_DOUBLE_EQ(icra2021.bed.sleep_distance_m, preset.bed.sleep_distance_m);
  EXPECT_EQ(icra2021.bed.max_substeps, preset.bed.max_substeps);
  EXPECT_EQ(icra2021.tool.shape, preset.tool.shape);
  EXPECT_TRUE(icra2021.tool.size_m.isApprox(preset.tool.size_m));
  EXPECT_DOUBLE_EQ(icra2021.tool.diameter_m, preset.tool.diameter_m);
  EXPECT_DOUBLE_EQ(icra2021.tool.thickness_m, preset.tool.thickness_m);
  EXPECT_DOUBLE_EQ(icra2021.tool.stiffness_n_m, preset.tool.stiffness_n_m);
  EXPECT_DOUBLE_EQ(icra2021.tool.damping_factor, preset.tool.damping_factor);
  EXPECT_DOUBLE_EQ(icra2021.tool.adhesion_ratio, preset.tool.adhesion_ratio);
  EXPECT_DOUBLE_EQ(icra2021.tool.friction, preset.tool.friction);
  EXPECT_DOUBLE_EQ(icra2021.tool.adhesion_n, preset.tool.adhesion_n);
  EXPECT_EQ(icra2021.hand.motion, preset.hand.motion);
  EXPECT_EQ(icra2021.hand.compliance, preset.hand.compliance);
  EXPECT_DOUBLE_EQ(icra2021.hand.mass_kg, preset.hand.mass_kg);
  EXPECT_DOUBLE_EQ(icra2021.hand.damping_n_s_m, preset.hand.damping_n_s_m);
  EXPECT_DOUBLE_EQ(icra2021.hand.stiffness_n_m, preset.hand.stiffness_n_m);
  EXPECT_DOUBLE_EQ(icra2021.hand.lever_m, preset.hand.lever_m);
  EXPECT_DOUBLE_EQ(icra2021.hand.period_s, preset.hand.period_s);
  EXPECT_DOUBLE_EQ(icra2021.hand.active_s, preset.hand.active_s);
  EXPECT_TRUE(icra2021.hand.home_m.isApprox(preset.hand.home_m));
  EXPECT_DOUBLE_EQ(icra2021.hand.depth_m, preset.hand.depth_m);
  EXPECT_EQ(icra2021.hand.surface_m, preset.hand.surface_m);
  EXPECT_DOUBLE_EQ(icra2021.hand.reach_m, preset.hand.reach_m);
  EXPECT_DOUBLE_EQ(icra2021.hand.max_force_n, preset.hand.max_force_n);
  EXPECT_DOUBLE_EQ(icra2021.hand.max_torque_nm, preset.hand.max_torque_nm);
  EXPECT_DOUBLE_EQ(icra2021.loop.duration_s, preset.loop.duration_s);
  EXPECT_EQ(icra2021.loop.real_time, preset.loop.real_time);
  EXPECT_DOUBLE_EQ(icra2021.loop.filter_cutoff_hz, preset.loop.filter_cutoff_hz);
}

TEST_F(LoadSceneFile, MillimetresBecomeMetresAndWordsBecomeMeanings) {
  const SceneFile scene = load(R"(
    [bed]
    start = "rain"
    width_mm = 250
    seed = 42
    [tool]
    shape = "sphere"
    size_mm = [10, 20.5, 30]
    [hand]
    compliance = "rigid"
    home_mm = [-1, 2, 300]
    [loop]
    real_time = false
  )");
  EXPECT_EQ(scene.bed.start, BedStart::kRain);
  EXPECT_DOUBLE_EQ(scene.bed.width_m, 0.25);
  EXPECT_EQ(scene.bed.seed, 42U);
  EXPECT_EQ(scene.tool.shape, ToolShape::kSphere);
  EXPECT_TRUE(scene.tool.size_m.isApprox(Vec3(0.01, 0.0205, 0.03)));
  EXPECT_EQ(scene.hand.compliance, HandCompliance::kRigid);
  EXPECT_TRUE(scene.hand.home_m.isApprox(Vec3(-0.001, 0.002, 0.3)));
  EXPECT_FALSE(scene.loop.real_time);
}

TEST_F(LoadSceneFile, APresetAtAnotherRadiusIsRescaled) {
  // Half the radius: gamma / 8, k / 2. Numbers that are also given are used unchanged, wherever they are.
  const SceneFile scene = load("[soil]\nradius_mm = 3.5\npreset = 'P4'\n");
  EXPECT_DOUBLE_EQ(scene.bed.soil.radius_m, 3.5e-3);
  EXPECT_DOUBLE_EQ(scene.bed.soil.gamma_nm, 6e-5 / 8);
  EXPECT_DOUBLE_EQ(scene.bed.soil.stiffness_n_m, 50);
  EXPECT_DOUBLE_EQ(scene.bed.soil.rho0_kg_m3, 1360);
  EXPECT_EQ(scene.preset, "P4");
  EXPECT_DOUBLE_EQ(load("[soil]\nstiffness_n_m = 80\nradius_mm = 3.5\n").bed.soil.stiffness_n_m, 80);
}

TEST_F(LoadSceneFile, SoilGivenByNumbersIsNoPreset) {
  const SceneFile scene = load("[soil]\ngamma_nm = 5e-5\n");
  EXPECT_EQ(scene.preset, "");
  EXPECT_DOUBLE_EQ(scene.bed.soil.gamma_nm, 5e-5);
  EXPECT_DOUBLE_EQ(scene.bed.soil.rho0_kg_m3, 1330);
}

TEST_F(LoadSceneFile, ThePreviousWordsForFrictionAreStillRead) {
  EXPECT_EQ(load("[soil]\npreset = 'P3'\nfriction = 'pairwise'\n").bed.soil.friction, FrictionModel::kContact);
  EXPECT_EQ(load("[soil]\npreset = 'P3'\nfriction_model = 'Pairwise'\n").bed.soil.friction, FrictionModel::kContact);
  EXPECT_EQ(load("[soil]\nname = 'dry-sand'\nfriction = 'paper'\n").bed.soil.friction, FrictionModel::kIcra2021);
  EXPECT_TRUE(findSceneFile("paper") == findSceneFile("icra2021")) << "the name of earlier versions";
}

TEST_F(LoadSceneFile, FrictionHasTwoModelsEachWithItsNumbers) {
  EXPECT_EQ(load("[soil]\npreset = 'P3'\n").bed.soil.friction, FrictionModel::kIcra2021);
  const SceneFile scene = load(R"(
    [soil]
    preset = "P3"
    radius_mm = 3.5
    friction_model = "Contact"
    contact_friction = 0.7
    contact_cohesion_n = 0.1
    cohesion_range_ratio = 0.2
    tangential_ratio = 0.4
    damping_ratio = 0.3
    [tool]
    friction = 0.5
    adhesion_n = 0.02
  )");
  const SoilParameters& soil = scene.bed.soil;
  EXPECT_EQ(soil.friction, FrictionModel::kContact);
  EXPECT_EQ(soil.contact_friction, 0.7);
  EXPECT_EQ(soil.contact_cohesion_n, 0.1) << "what is given is for the radius that is given";
  EXPECT_EQ(soil.cohesion_range_ratio, 0.2);
  EXPECT_EQ(soil.tangential_ratio, 0.4);
  EXPECT_EQ(soil.damping_ratio, 0.3);
  EXPECT_EQ(scene.tool.friction, 0.5);
  EXPECT_EQ(scene.tool.adhesion_n, 0.02);
  EXPECT_EQ(scene.preset, "P3") << "a preset says nothing about these";
}

TEST_F(LoadSceneFile, GravityHasABodyOrAMagnitudeAndADirection) {
  const SceneFile mars = load("[gravity]\nbody = 'mars'\ndirection = [0, 3, -4]\n");
  EXPECT_EQ(mars.body, "Mars");
  EXPECT_TRUE(mars.bed.gravity_m_s2.isApprox(3.721 * Vec3(0, 0.6, -0.8)));
  const SceneFile none = load("[gravity]\nmagnitude_m_s2 = 0\n");
  EXPECT_EQ(none.body, "");
  EXPECT_TRUE(none.bed.gravity_m_s2.isZero());
}

TEST_F(LoadSceneFile, PosesLieBesideTheSceneAndImplyTheMotion) {
  std::ofstream(folder_ / "move.csv") << "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
  const SceneFile scene = load("[hand]\nposes = 'move.csv'\n");
  EXPECT_EQ(scene.hand.motion, HandMotion::kPoses);
  EXPECT_EQ(fs::path(scene.hand.poses_file), folder_ / "move.csv");
  EXPECT_NO_THROW((void)load("[hand]\nposes = 'move.csv'\nmotion = 'poses'\n"));
}

// --- what is refused, and in which words ---

TEST_F(LoadSceneFile, JawsAreBentNoMoreThanGrainsFitInto) {
  EXPECT_THAT(errorOf("[tool]\nshape = 'jaws'\njaw_bend_deg = 181\n"),
              HasSubstr("x.toml:3: [tool] jaw_bend_deg = 181"));
  // 50 mm long and 5 mm thick round grains of 14 mm: 50 / 9.5 = 5.26 rad, never too much; of 30 mm: 2.86.
  EXPECT_NO_THROW((void)sceneFileFromText("[tool]\nshape = 'jaws'\njaw_bend_deg = 180\n", "x.toml"));
  EXPECT_THAT(errorOf("[soil]\nradius_mm = 15\n[tool]\nshape = 'jaws'\njaw_bend_deg = 180\n"),
              AllOf(HasSubstr("jaw_bend"), HasSubstr("30 mm")));
}

TEST_F(LoadSceneFile, UnknownKeysSuggestTheNearest) {
  EXPECT_EQ(errorOf("[soil]\n\nrho_max = 1900\n"),
            "x.toml:3: [soil] rho_max is not known; did you mean [soil] rho_max_kg_m3?");
  EXPECT_EQ(errorOf("titel = 'x'\n"), "x.toml:1: titel is not known; did you mean title?");
  EXPECT_EQ(errorOf("title = 'x'\n[sol]\n"), "x.toml:2: [sol] is not known; did you mean [soil]?");
  EXPECT_EQ(errorOf("[bed]\npreset = 'P1'\n"), "x.toml:2: [bed] preset is not known; did you mean [soil] preset?");
  EXPECT_EQ(errorOf("[bed]\ncolour = 'red'\n"), "x.toml:2: [bed] colour is not known, see docs/reference/scenes.md");
}

TEST_F(LoadSceneFile, WrongTypesAreRefused) {
  EXPECT_EQ(errorOf("[soil]\nmu_hat = '0.3'\n"),
            "x.toml:2: [soil] mu_hat = '0.3' is not valid: must be a number, 0 to 10");
  EXPECT_EQ(errorOf("[soil]\nmu_hat = true\n"),
            "x.toml:2: [soil] mu_hat = true is not valid: must be a number, 0 to 10");
  EXPECT_EQ(errorOf("[bed]\nlayers = 3.0\n"),
            "x.toml:2: [bed] layers = 3.0 is not valid: must be a whole number, 1 to 1000");
  EXPECT_EQ(errorOf("[loop]\nreal_time = 1\n"), "x.toml:2: [loop] real_time = 1 is not valid: must be true or false");
  EXPECT_EQ(errorOf("title = 3\n"), "x.toml:1: title = 3 is not valid: must be a line of text");
  EXPECT_EQ(errorOf("title = ''\n"), "x.toml:1: title = '' is not valid: must be text that is not empty");
  EXPECT_EQ(errorOf("soil = 'P3'\n"), "x.toml:1: soil = 'P3' is not valid: must be a table, [soil]");
  EXPECT_THAT(errorOf("[[soil]]\npreset = 'P3'\n"), HasSubstr("must be a table, [soil]"));
  EXPECT_EQ(errorOf("[tool]\nsize_mm = [50, 40]\n"),
            "x.toml:2: [tool] size_mm = [ 50, 40 ] is not valid: must be three numbers, each 0.01 to 10000");
  EXPECT_THAT(errorOf("[tool]\nsize_mm = [50, 'wide', 5]\n"), HasSubstr("x.toml:2: [tool] size_mm = 'wide'"));
  EXPECT_THAT(errorOf("[tool]\nsize_mm = 50\n"), HasSubstr("must be three numbers"));
  EXPECT_EQ(errorOf("[soil.preset]\nname = 'P3'\n"),
            "x.toml:1: [soil] preset = a table is not valid: must be P1, P2, P3, P4, P5 or P6");
  EXPECT_THAT(errorOf("[hand]\nperiod_s = 1979-05-27\n"), HasSubstr("must be a number"));
}

TEST_F(LoadSceneFile, ValuesOutOfRangeAreRefused) {
  EXPECT_EQ(errorOf("[soil]\nmu_hat = -1\n"), "x.toml:2: [soil] mu_hat = -1 is not valid: must be 0 to 10");
  EXPECT_EQ(errorOf("[soil]\npreset = 'P9'\n"),
            "x.toml:2: [soil] preset = 'P9' is not valid: must be P1, P2, P3, P4, P5 or P6");
  EXPECT_EQ(errorOf("[gravity]\nbody = 'Vulcan'\n"),
            "x.toml:2: [gravity] body = 'Vulcan' is not valid: must be Ceres, Pluto, Europa, Moon, Mars or Earth");
  EXPECT_THAT(errorOf("[gravity]\ndirection = [0, 0, 0]\n"), HasSubstr("x.toml:2: [gravity] direction = [ 0, 0, 0 ]"));
  EXPECT_EQ(errorOf("[bed]\nparticles = 0\n"),
            "x.toml:2: [bed] particles = 0 is not valid: must be a whole number, 1 to 10000000");
  EXPECT_THAT(errorOf("[bed]\nparticles = 99999999999999\n"), HasSubstr("1 to 10000000"));
  EXPECT_THAT(errorOf("[bed]\nseed = -1\n"), HasSubstr("x.toml:2: [bed] seed = -1"));
}

TEST_F(LoadSceneFile, NonsenseAboutFrictionIsRefused) {
  EXPECT_EQ(errorOf("[soil]\nfriction_model = 'none'\n"),
            "x.toml:2: [soil] friction_model = 'none' is not valid: must be icra2021 or contact");
  EXPECT_EQ(errorOf("[soil]\nfriction_model = 0.7\n"),
            "x.toml:2: [soil] friction_model = 0.7 is not valid: must be icra2021 or contact");
  EXPECT_EQ(errorOf("[soil]\n\ncontact_friction = -0.7\n"),
            "x.toml:3: [soil] contact_friction = -0.7 is not valid: must be 0 to 10");
  EXPECT_EQ(errorOf("[soil]\ncohesion_range_ratio = 0\n"),
            "x.toml:2: [soil] cohesion_range_ratio = 0 is not valid: must be 0.001 to 0.5");
  EXPECT_THAT(errorOf("[soil]\ncontact_cohesion_n = nan\n"), HasSubstr("contact_cohesion_n = nan is not valid"));
  EXPECT_THAT(errorOf("[soil]\ntangential_ratio = 2\n"), HasSubstr("must be 0.01 to 1"));
  EXPECT_THAT(errorOf("[soil]\ndamping_ratio = 0.6\n"), HasSubstr("must be 0 to 0.5"));
  EXPECT_THAT(errorOf("[tool]\nfriction = 11\n"), HasSubstr("x.toml:2: [tool] friction = 11"));
  EXPECT_THAT(errorOf("[tool]\nadhesion_n = -1\n"), HasSubstr("x.toml:2: [tool] adhesion_n = -1"));
}

TEST_F(LoadSceneFile, NanAndInfinityAreRefused) {
  EXPECT_EQ(errorOf("[soil]\ngamma_nm = nan\n"), "x.toml:2: [soil] gamma_nm = nan is not valid: must be > 0");
  EXPECT_EQ(errorOf("[soil]\nstiffness_n_m = inf\n"), "x.toml:2: [soil] stiffness_n_m = inf is not valid: must be > 0");
  EXPECT_THAT(errorOf("[hand]\nhome_mm = [0, -inf, 0]\n"), HasSubstr("x.toml:2: [hand] home_mm = -inf"));
}

TEST_F(LoadSceneFile, ValuesThatDoNotGoTogetherAreRefused) {
  EXPECT_THAT(errorOf("[soil]\nrho0_kg_m3 = 1330\nrho_max_kg_m3 = 1000\n"),
              HasSubstr("x.toml:3: [soil] rho_max_kg_m3 = 1000 is not valid: must be > 1330"));
  EXPECT_THAT(
      errorOf("[soil]\nrho0_kg_m3 = 2000\n"),
      HasSubstr("x.toml: [soil] rho_max_kg_m3 = 1824 (left out, so as in icra2021) is not valid: must be > 2000"));
  EXPECT_THAT(errorOf("[bed]\nlength_mm = 200\nwidth_mm = 5\n"), HasSubstr("x.toml:3: [bed] width_mm = 5"));
  EXPECT_EQ(errorOf("[soil]\npreset = 'P1'\nmu_hat = 0.3\n"),
            "x.toml:3: [soil] preset and mu_hat cannot both be given");
  EXPECT_EQ(errorOf("[gravity]\nmagnitude_m_s2 = 1\nbody = 'Moon'\n"),
            "x.toml:3: [gravity] body and magnitude_m_s2 cannot both be given");
  EXPECT_EQ(errorOf("[hand]\nmotion = 'press'\nposes = 'a.csv'\n"),
            "x.toml:3: [hand] poses and motion cannot both be given");
}

TEST_F(LoadSceneFile, ALimitThatFollowsFromOtherValuesIsToldInTheUnitOfTheKey) {
  EXPECT_EQ(errorOf("[bed]\nwidth_mm = 5\n"), "x.toml:2: [bed] width_mm = 5 is not valid: must be 14 to 100000 (mm)");
  EXPECT_THAT(errorOf("[soil]\nradius_mm = 80\n"),
              HasSubstr("[bed] width_mm = 126 (left out, so as in icra2021) is not valid: must be 160 to 100000 (mm)"));
}

TEST_F(LoadSceneFile, WordsSuggestTheNearest) {
  EXPECT_THAT(errorOf("[soil]\nname = 'lunar-0-15'\n"), HasSubstr("; did you mean lunar-0-15cm?"));
}

TEST_F(LoadSceneFile, AKeyThatCanNeverHaveAnEffectIsRefused) {
  EXPECT_EQ(errorOf("[bed]\ndepth_mm = 90\n"),
            "x.toml:2: [bed] depth_mm has no effect: it needs [bed] start = packed or settled");
  EXPECT_EQ(errorOf("[coupling]\nkind = 'direct'\nstiffness_n_m = 300\n"),
            "x.toml:3: [coupling] stiffness_n_m has no effect: it needs [coupling] kind = auto or virtual");
  EXPECT_NO_THROW((void)load("[bed]\ndepth_mm = 40\n")) << "the usual value, as the scene icra2021 writes it out";
  EXPECT_NO_THROW((void)loadSceneFileText("[bed]\ndepth_mm = 90\n", "a recording"));
}

TEST_F(LoadSceneFile, AKeyThatHasNoEffectYetIsTold) {
  const fs::path path =
      write("[soil]\npreset = 'P3'\ncontact_friction = 0.4\n[tool]\nshape = 'sphere'\nsize_mm = [1, 2, 3]\n");
  const SceneFile scene = loadSceneFile(path);
  EXPECT_THAT(idleKeys(path.string(), scene),
              testing::ElementsAre(
                  path.string() + ":3: [soil] contact_friction has no effect: it needs [soil] friction_model = contact",
                  path.string() + ":6: [tool] size_mm has no effect: it needs [tool] shape = box or jaws"));
  SceneFile switched = scene;
  switched.bed.soil.friction = FrictionModel::kContact;
  switched.tool.shape = ToolShape::kJaws;
  EXPECT_THAT(idleKeys(path.string(), switched), testing::IsEmpty());
}

TEST_F(LoadSceneFile, ShippedScenesHaveNoKeyWithoutEffect) {
  for (const fs::directory_entry& entry : fs::directory_iterator(sourceDir() / "scenes")) {
    if (entry.path().extension() == ".toml") {
      EXPECT_THAT(idleKeys(entry.path().string(), loadSceneFile(entry.path())), testing::IsEmpty());
    }
  }
}

TEST_F(LoadSceneFile, BuiltInScenesAreTheFilesByTheirNames) {
  for (const std::string& name : sceneNames()) {
    if (name != "plate-recorded") {  // its poses are next to the file
      EXPECT_EQ(findSceneFile(name), loadSceneFile(sourceDir() / "scenes" / (name + ".toml"))) << name;
    }
  }
  EXPECT_THAT(sceneNames(), testing::IsSupersetOf({"icra2021", "rain", "sandbox"}));
  EXPECT_THAT([] { (void)findSceneFile("sandbx"); },
              testing::ThrowsMessage<InvalidParameter>(HasSubstr("did you mean sandbox?")));
}

TEST_F(LoadSceneFile, PosesMustExist) {
  EXPECT_EQ(errorOf("[hand]\nmotion = 'poses'\n"), "x.toml:2: [hand] motion = 'poses' needs [hand] poses, a CSV file");
  EXPECT_THAT(errorOf("[hand]\nposes = 'none.csv'\n"), HasSubstr("none.csv: no such file"));
}

TEST_F(LoadSceneFile, WhatIsNotTomlIsRefusedWithItsLine) {
  EXPECT_THAT(errorOf("title = 'x'\n[soil\n"), HasSubstr("x.toml:2: not TOML: "));
  EXPECT_THAT(errorOf("[soil]\nmu_hat = 1\nmu_hat = 2\n"), HasSubstr("x.toml:3: not TOML: "));
  EXPECT_THAT(errorOf("title = \"\xff\xfe\"\n"), HasSubstr("not TOML: "));
  EXPECT_THAT(errorOf(std::string("title = 'a\0b'\n", 14)), HasSubstr("not TOML: "));
}

TEST_F(LoadSceneFile, EmptyMissingAndHugeFilesAreRefused) {
  EXPECT_THAT(errorOf(""), HasSubstr("x.toml: empty: a scene has at least one key"));
  EXPECT_THAT(errorOf("# only a remark\n\n"), HasSubstr("x.toml: empty"));
  EXPECT_THAT(errorOf("title = '" + std::string(2 << 20, 'x') + "'\n"), HasSubstr("x.toml: too large"));
  EXPECT_THAT([&] { (void)loadSceneFile(folder_ / "none.toml"); },
              testing::ThrowsMessage<TomlError>(HasSubstr("none.toml: no such file")));
  EXPECT_THAT([&] { (void)loadSceneFile(folder_); }, testing::ThrowsMessage<TomlError>(HasSubstr(": not a file")));
  EXPECT_THAT([&] { (void)loadSceneFile("/dev/zero"); }, testing::ThrowsMessage<TomlError>("/dev/zero: not a file"));
}

TEST_F(LoadSceneFile, LongValuesAreShortenedInMessages) {
  const std::string message = errorOf("[soil]\npreset = '" + std::string(5000, 'P') + "'\n");
  EXPECT_LT(message.size(), 200U);
}

}  // namespace
}  // namespace haptolith
