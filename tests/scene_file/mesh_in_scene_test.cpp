// Users' meshes as tools in scene files: meaning of the keys, refusals, and that a scene carries its mesh
// along.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "haptolith/scene/scene.h"
#include "haptolith/scene_file/built_in_tools.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/tool/tool_mesh.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class MeshInAScene : public testing::Test {
 protected:
  MeshInAScene() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_mesh_in_scene_{}", getpid())) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "wedge.obj")
        << "v 0 0 0\nv 30 0 0\nv 0 20 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    std::ofstream(folder_ / "flat.obj") << "v 0 0 0\nv 30 0 0\nv 0 20 0\nf 1 2 3\n";
    std::ofstream(folder_ / "broken.stl") << "solid\nfacet\nvertex 1 2\n";
    std::ofstream(folder_ / "tool.step") << "ISO-10303-21;\n";
  }
  ~MeshInAScene() override { fs::remove_all(folder_); }

  [[nodiscard]] SceneFile sceneOf(const std::string& tool, const std::vector<std::string>& overrides = {}) const {
    return sceneFileFromText("[tool]\n" + tool, (folder_ / "x.toml").string(), overrides);
  }
  [[nodiscard]] std::string errorOf(const std::string& tool) const {
    try {
      (void)sceneOf(tool);
    } catch (const InvalidParameter& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
};

TEST_F(MeshInAScene, IsFoundBesideTheSceneFileAndPlaced) {
  const SceneFile scene =
      sceneOf("mesh_unit_mm = 2\nmesh_origin_mm = [0, 0, 20]\nmesh_turn_deg = [0, 0, 90]\nmesh = 'wedge.obj'\n");
  ASSERT_NE(scene.tool.mesh, nullptr);
  EXPECT_EQ(scene.tool.shape, ToolShape::kMesh);
  const MeshCorners& corners = scene.tool.mesh->field.corners();
  EXPECT_LT((corners.low_m - Vec3(-0.04, 0, -0.02)).norm(), 1e-9);
  EXPECT_LT((corners.high_m - Vec3(0, 0.06, 0)).norm(), 1e-9);
  EXPECT_EQ(sceneOf("shape = 'mesh'\nmesh = 'wedge.obj'\n").tool.shape, ToolShape::kMesh);
}

TEST_F(MeshInAScene, RefusesWhatIsNoToolAndSaysWhere) {
  EXPECT_THAT(errorOf("mesh = 'gone.stl'\n"), HasSubstr("no such file"));
  EXPECT_THAT(errorOf("mesh = 'tool.step'\n"), AllOf(HasSubstr("x.toml:2"), HasSubstr(".stl, .obj, .glb or .gltf")));
  EXPECT_THAT(errorOf("mesh = 'broken.stl'\n"), AllOf(HasSubstr("x.toml:2"), HasSubstr("broken.stl")));
  EXPECT_THAT(errorOf("mesh = 'flat.obj'\n"), AllOf(HasSubstr("x.toml:2"), HasSubstr("flat.obj")));
  EXPECT_THAT(errorOf("mesh_unit_mm = 1000\nmesh = 'wedge.obj'\n"), HasSubstr("with a unit of 1 mm"));
  try {
    (void)sceneOf("shape = 'box'\n", {"tool.mesh=" + (folder_ / "flat.obj").string()});
    FAIL() << "flat.obj is no tool";
  } catch (const InvalidParameter& error) {
    EXPECT_THAT(error.what(), HasSubstr("override tool.mesh="));
  }
  EXPECT_THAT(errorOf("shape = 'mesh'\n"), HasSubstr("needs [tool] mesh"));
  EXPECT_THAT(errorOf("shape = 'box'\nmesh = 'wedge.obj'\n"), HasSubstr("cannot both be given"));
  EXPECT_THAT(errorOf("model = 'scoop'\nmesh = 'wedge.obj'\n"), HasSubstr("cannot both be given"));
  EXPECT_THAT(errorOf("name = 'spoon'\n"), HasSubstr("did you mean scoop?"));
  EXPECT_THAT(errorOf("mesh_data = 'obj-'\n"), HasSubstr("stl, obj or gltf, a colon, and base64"));
  EXPECT_THAT(errorOf("mesh_data = 'ply:Zm9v'\n"), HasSubstr("mesh_data"));
}

TEST_F(MeshInAScene, OfASheetHasTheThicknessThatItIsGiven) {
  const SceneFile scene = sceneOf("mesh_sheet_mm = 2\nmesh = 'flat.obj'\n");
  const DistanceField& field = scene.tool.mesh->field;
  EXPECT_NEAR(field.corners().high_m.z() - field.corners().low_m.z(), 2e-3, 1e-9);
  EXPECT_EQ(scene.tool.mesh->surface.triangles.size(), 2U + 6U) << "both sides and three walls";
}

TEST_F(MeshInAScene, TravelsWithItsText) {
  const SceneFile scene = sceneOf("mesh_turn_deg = [10, 0, 0]\nmesh = 'wedge.obj'\n");
  const std::string text = sceneFileText(scene);
  fs::remove(folder_ / "wedge.obj");
  const SceneFile again = loadSceneFileText(text, "the recorded scene");
  EXPECT_TRUE(again == scene);
  EXPECT_EQ(again.tool.mesh, scene.tool.mesh) << "made but once";
  EXPECT_EQ(again.mesh.name, "wedge.obj");
}

TEST_F(MeshInAScene, GivesWayToAShapeThatIsAskedForAndComesBack) {
  const SceneFile ball = sceneOf("mesh = 'wedge.obj'\n", {"tool.shape=sphere"});
  EXPECT_EQ(ball.tool.shape, ToolShape::kSphere);
  EXPECT_EQ(sceneOf("shape = 'box'\n", {"tool.model=rake"}).mesh.name, "rake");
  EXPECT_EQ(sceneOf("mesh_turn_deg = [90, 0, 0]\nmesh = 'wedge.obj'\n", {"tool.model=rake"}).mesh.turn_rad,
            Vec3::Zero())
      << "that was how the other one is held";
  EXPECT_EQ(sceneOf("mesh = 'wedge.obj'\n", {"tool.shape=mesh"}).mesh.name, "wedge.obj");
  const std::string mesh = "tool.mesh=" + (folder_ / "wedge.obj").string();
  EXPECT_EQ(sceneOf("shape = 'box'\n", {mesh}).mesh.name, "wedge.obj");

  const SceneFile rake = sceneOf("model = 'rake'\n");
  const SceneFile shown = changed(rake, std::vector<std::string>{"tool.shape=sphere"});
  EXPECT_EQ(shown.tool.shape, ToolShape::kSphere);
  EXPECT_EQ(changed(shown, std::vector<std::string>{"tool.shape=mesh"}).tool.mesh, rake.tool.mesh);
}

constexpr const char* kScraper =
    "\n[[tool_part]]\nsize_mm = [5, 60, 30]\n"
    "[[tool_part]]\nshape = 'cylinder'\ndiameter_mm = 12\nlength_mm = 80\nat_mm = [0, 0, 50]\nturn_deg = [0, 0, 45]\n";

TEST_F(MeshInAScene, MayBePutTogetherOfParts) {
  const SceneFile scene = sceneOf(std::string("stiffness_n_m = 9000\n") + kScraper);
  EXPECT_EQ(scene.tool.shape, ToolShape::kMesh);
  EXPECT_EQ(scene.tool.stiffness_n_m, 9000);
  const MeshCorners& corners = scene.tool.mesh->field.corners();
  EXPECT_LT((corners.low_m - Vec3(-0.006, -0.03, -0.015)).norm(), 1e-5);
  EXPECT_LT((corners.high_m - Vec3(0.006, 0.03, 0.09)).norm(), 1e-5);
  EXPECT_TRUE(scene.tool.mesh->report.empty());
  EXPECT_TRUE(loadSceneFileText(sceneFileText(scene), "the recorded scene") == scene);
  EXPECT_EQ(sceneOf(kScraper, {"tool.shape=sphere"}).tool.shape, ToolShape::kSphere);
  EXPECT_EQ(sceneOf(kScraper, {"tool.model=rake"}).mesh.name, "rake");
  EXPECT_EQ(sceneOf(kScraper, {"tool.shape=mesh"}).mesh.bytes->size(), scene.mesh.bytes->size());
}

TEST_F(MeshInAScene, OfPartsRefusesWhatDoesNotFit) {
  EXPECT_THAT(errorOf(std::string("model = 'rake'\n") + kScraper), HasSubstr("put together of [[tool_part]]"));
  EXPECT_THAT(errorOf(std::string("shape = 'box'\n") + kScraper), HasSubstr("put together of [[tool_part]]"));
  EXPECT_THAT(errorOf(std::string("mesh_unit_mm = 2\n") + kScraper), HasSubstr("put together of [[tool_part]]"));
  EXPECT_THAT(errorOf("\n[[tool_part]]\nshape = 'sphere'\nsize_mm = [1, 2, 3]\n"), HasSubstr("a sphere has none"));
  EXPECT_THAT(errorOf("\n[[tool_part]]\nlength_mm = 10\n"), HasSubstr("a box has none"));
  EXPECT_THAT(errorOf("\n[[tool_part]]\nshape = 'sphere'\ndiameter_mm = 0\n"),
              AllOf(HasSubstr("diameter_mm"), HasSubstr("0.5 to 1000")));
  std::string many;
  for (int i = 0; i < 65; ++i) {
    many += "\n[[tool_part]]\nshape = 'sphere'\n";
  }
  EXPECT_THAT(errorOf(many), AllOf(HasSubstr("65"), HasSubstr("1 to 64")));
  EXPECT_THAT(errorOf("\n[[tool_part]]\ncolour = 'red'\n"), HasSubstr("colour"));
  EXPECT_THAT(errorOf("\n[[tool_part]]\nsize_mm = [40, 40, 0.5]\n"), AllOf(HasSubstr("x.toml:3"), HasSubstr("walls")));
}

// --- the tools that ship along ---------------------------------------------------------------------------------------

double distanceAt(const SceneFile& scene, const Vec3& place_mm) {
  return scene.tool.mesh->field.at(1e-3 * place_mm).distance_m;
}

TEST(BuiltInTools, AreSolidWhereTheyShouldBeAndHollowWhereSoilGoes) {
  struct Place {
    const char* tool;
    Vec3 at_mm;
    bool solid;
  };
  const Place places[]{
      {"scoop", {0, 0, -10.3}, true},      {"scoop", {0, 0, 0}, false},       {"scoop", {-29.3, 0, 0}, true},
      {"scoop", {29, 0, 0}, false},        {"scoop", {-10, 21.8, 0}, true},   {"bucket", {0, 0, 0}, false},
      {"bucket", {15, 0, -21}, true},      {"bucket", {-17, 0, 10}, true},    {"bucket", {0, 24, 0}, true},
      {"bucket", {36, 6.5, -21}, true},    {"bucket", {36, 0, -21}, false},   {"rake", {0, 14, -15}, true},
      {"rake", {0, 7, -15}, false},        {"rake", {0, 7, 12}, true},        {"corer", {0, 0, 0}, false},
      {"corer", {19.2, 0, 0}, true},       {"corer", {0, -19.2, 30}, true},   {"auger", {0, 0, 0}, true},
      {"auger", {14.1, 5.1, -34.7}, true}, {"auger", {15, 0, -25}, false},    {"auger", {-15, 0, -24}, true},
      {"wheel", {0, 0, 0}, true},          {"wheel", {39, 0, 0}, true},       {"wheel", {38, 10, 0}, false},
      {"bucket-drum", {15, 0, 0}, false},  {"bucket-drum", {33, 1, 0}, true}, {"bucket-drum", {-8.5, 31.9, 0}, false}};
  SceneFile scene;  // the one before is kept until another is made
  for (const Place& place : places) {
    scene = sceneFileFromText(fmt::format("[tool]\nmodel = '{}'\n", place.tool), "x.toml");
    EXPECT_EQ(distanceAt(scene, place.at_mm) < 0, place.solid) << place.tool << " " << place.at_mm.transpose();
  }
}

TEST(BuiltInTools, NeedNoMendingAndFitIntoAHand) {
  for (const BuiltInTool& tool : builtInTools()) {
    const SceneFile scene = sceneFileFromText(fmt::format("[tool]\nmodel = '{}'\n", tool.name), "x.toml");
    EXPECT_EQ(scene.tool.mesh->report, std::vector<std::string>{}) << tool.name;
    EXPECT_LT(scene.tool.mesh->field.enclosingRadius(), 0.06) << tool.name;
    EXPECT_EQ(scene.tool.mesh->field.spacing(), 0.4e-3) << tool.name;
    EXPECT_LT(scene.tool.mesh->field.bytes(), std::size_t{40} << 20) << tool.name;
  }
}

TEST(DrawnTools, TheScoopCarriesALoadThatWeighsWhatItWeighs) {
  const SceneFile scene_file = sceneFileFromText(
      "[tool]\nmodel = 'scoop'\n[soil]\nname = 'lunar-0-15cm'\nradius_mm = 4\n[bed]\nwidth_mm = 400\n", "x.toml");
  constexpr double kHeight_m = 0.1;
  std::vector<Vec3> grains{{-0.19, -0.05, 0.004}};  // in a corner of the box: the soil's surface
  for (int x = 0; x < 5; ++x) {
    for (int y = 0; y < 4; ++y) {
      for (int z = 0; z < 2; ++z) {
        grains.emplace_back(-0.022 + 0.0085 * x, -0.013 + 0.0085 * y, kHeight_m - 0.005 + 0.0085 * z);
      }
    }
  }
  const auto load = static_cast<double>(grains.size() - 1);
  Scene scene(scene_file.bed, scene_file.tool, grains);
  scene.placeTool({{{Vec3(0, 0, kHeight_m), Quat::Identity()}, {}}});
  HandState hand{{scene.toolPose(), {}}};
  for (int i = 0; i < 1500; ++i) {
    ASSERT_EQ(scene.tick(hand), StepStatus::kOk);
  }
  const double mass_kg = load * macroparticleMass(scene_file.bed.soil);
  const double weight_n = -mass_kg * scene_file.bed.gravity_m_s2.z();
  EXPECT_NEAR(scene.soilWrench().force_n.z(), -weight_n, 0.03 * weight_n);
  // Sideways with 0.5 m/s^2 for 0.4 s.
  constexpr double kFaster_m_s2 = 0.5;
  double pushed_ns = 0;
  for (int i = 1; i <= 400; ++i) {
    const double t = 1e-3 * i;
    hand.pose.position_m.y() = kFaster_m_s2 / 2 * t * t;
    hand.twist.linear_m_s.y() = kFaster_m_s2 * t;
    ASSERT_EQ(scene.tick(hand), StepStatus::kOk);
    pushed_ns -= 1e-3 * scene.soilWrench().force_n.y();
  }
  EXPECT_NEAR(pushed_ns, mass_kg * kFaster_m_s2 * 0.4, 0.1 * mass_kg * kFaster_m_s2 * 0.4);
  for (std::size_t i = 1; i < grains.size(); ++i) {
    EXPECT_GT(scene.bed().state().position[i].z, kHeight_m - 0.012) << i << " has been lost";
  }
}

}  // namespace
}  // namespace haptolith
