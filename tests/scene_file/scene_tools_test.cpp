#include <gmock/gmock.h>

#include <numbers>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/scene_file/scene_file.h"

namespace haptolith {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Texts = std::vector<std::string>;

constexpr const char* kTwo =
    "[tool]\nshape = 'sphere'\ndiameter_mm = 30\n"
    "[hand]\nmotion = 'press'\ncompliance = 'rigid'\n"
    "[[tools]]\nname = 'left'\n[tools.hand]\nhome_mm = [-40, 0, 85]\n"
    "[[tools]]\nname = 'right'\nshape = 'cylinder'\n"
    "joint_drive = 'speed'\njoint_axis = [0, 0, 2]\njoint_speed_rad_s = 3\n"
    "[tools.hand]\nhome_mm = [40, 0, 85]\nmotion = 'scoop'\n[tools.coupling]\nkind = 'virtual'\n";

SceneFile with(const std::string& text, const Texts& overrides = {}) {
  return sceneFileFromText(text, "mine.toml", overrides);
}

std::string errorOf(const std::string& text, const Texts& overrides = {}) {
  try {
    (void)with(text, overrides);
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "no error";
}

TEST(SceneTools, HaveWhatTheySayAndElseWhatTheFileSaysOfAll) {
  const SceneFile scene = with(kTwo);
  EXPECT_THAT(toolNames(scene), ElementsAre("left", "right"));
  const SceneTool& right = scene.more_tools.at(0);
  EXPECT_EQ(scene.tool.shape, ToolShape::kSphere);
  EXPECT_DOUBLE_EQ(scene.tool.diameter_m, 0.03);
  EXPECT_EQ(scene.hand.motion, HandMotion::kPress);
  EXPECT_EQ(scene.hand.home_m.x(), -0.04);
  EXPECT_EQ(scene.handling.coupling.kind, CouplingKind::kAuto);
  EXPECT_FALSE(scene.tool.joint.any());
  EXPECT_EQ(right.tool.shape, ToolShape::kCylinder);
  EXPECT_DOUBLE_EQ(right.tool.diameter_m, 0.03) << "of [tool]";
  EXPECT_EQ(right.tool.joint.drive, Drive::kSpeed);
  EXPECT_EQ(right.tool.joint.axis, Vec3::UnitZ()) << "made a unit vector";
  EXPECT_EQ(right.hand.motion, HandMotion::kScoop);
  EXPECT_EQ(right.hand.compliance, HandCompliance::kRigid) << "of [hand]";
  EXPECT_EQ(right.handling.coupling.kind, CouplingKind::kVirtual);
  EXPECT_EQ(toolSet(scene).all().size(), 2U);
}

TEST(SceneTools, AreWrittenAndReadBackAsTheyWere) {
  const SceneFile scene = with(kTwo);
  const SceneFile again = loadSceneFileText(sceneFileText(scene), "the recorded scene");
  EXPECT_TRUE(again == scene);
  const SceneFile named = with("[[tools]]\nname = 'only'\nmodel = 'auger'\n");
  EXPECT_TRUE(loadSceneFileText(sceneFileText(named), "the recorded scene") == named);
  EXPECT_EQ(named.tool_name, "only");
}

TEST(SceneTools, AreChangedByNameOrAllTogether) {
  const SceneFile scene = with(kTwo, {"tools.left.shape=box", "tools.right.hand.motion=cut", "tool.friction=0.1"});
  EXPECT_EQ(scene.tool.shape, ToolShape::kBox);
  EXPECT_EQ(scene.more_tools.at(0).tool.shape, ToolShape::kCylinder);
  EXPECT_EQ(scene.more_tools.at(0).hand.motion, HandMotion::kCut);
  EXPECT_EQ(scene.tool.friction, 0.1);
  EXPECT_EQ(scene.more_tools.at(0).tool.friction, 0.1);
  const SceneFile all = with(kTwo, {"tool.shape=plate"});
  EXPECT_EQ(all.tool.shape, ToolShape::kPlate);
  EXPECT_EQ(all.more_tools.at(0).tool.shape, ToolShape::kPlate) << "although it says another shape";

  const SceneFile later = changed(scene, Texts{"tools.right.shape=sphere", "tool.friction=0.2"});
  EXPECT_EQ(later.tool.shape, ToolShape::kBox);
  EXPECT_EQ(later.more_tools.at(0).tool.shape, ToolShape::kSphere);
  EXPECT_EQ(later.more_tools.at(0).hand.motion, HandMotion::kCut) << "as it was";
  EXPECT_EQ(later.more_tools.at(0).tool.friction, 0.2);
  EXPECT_EQ(later.tool.friction, 0.2);
}

TEST(SceneTools, AreRefusedWhereOnlyOneIsExamined) {
  EXPECT_NO_THROW(requireOneTool(with("[bed]\nseed = 1\n"), "a robot"));
  EXPECT_THAT([] { requireOneTool(with(kTwo), "a robot"); },
              testing::ThrowsMessage<InvalidParameter>(HasSubstr("a scene with one tool for a robot")));
}

TEST(SceneTools, MeshesArePutTogetherOfTheirOwnParts) {
  const SceneFile scene = with(
      "[tool]\nshape = 'sphere'\n[[tools]]\nname = 'a'\n[[tools.tool_part]]\nsize_mm = [5, 60, 30]\n"
      "[[tools]]\nname = 'b'\nmodel = 'rake'\n[[tools]]\nname = 'c'\n");
  EXPECT_EQ(scene.mesh.name, "parts");
  EXPECT_NE(scene.tool.mesh, nullptr);
  EXPECT_EQ(scene.more_tools.at(0).mesh.name, "rake");
  EXPECT_NE(scene.more_tools.at(0).tool.mesh, nullptr);
  EXPECT_EQ(scene.more_tools.at(1).tool.shape, ToolShape::kSphere);
  EXPECT_EQ(with("[tool]\nmodel = 'rake'\n[[tools]]\nname = 'a'\nshape = 'box'\n").tool.shape, ToolShape::kBox);
}

TEST(SceneTools, RefusesNonsenseWithItsPlace) {
  std::string many;
  for (int i = 0; i < 17; ++i) {
    many += "[[tools]]\nname = 't" + std::to_string(i) + "'\n";
  }
  EXPECT_THAT(errorOf(many), HasSubstr("17 [[tools]] are not valid: must be at most 16"));
  EXPECT_THAT(errorOf("[[tools]]\nname = 'a'\n[[tools]]\nname = 'a'\n"),
              HasSubstr("mine.toml:4: [[tools]] name = 'a' is not valid: must be another name"));
  EXPECT_THAT(errorOf("[[tools]]\nshape = 'box'\n"), HasSubstr("[[tools]] name is missing"));
  EXPECT_THAT(errorOf("[[tools]]\nname = 'A b'\n"), HasSubstr("1 to 32 of a to z"));
  EXPECT_THAT(errorOf("[[tools]]\nname = 'a'\nshpe = 'box'\n"), HasSubstr("did you mean [[tools]] shape?"));
  EXPECT_THAT(errorOf("[[tools]]\nname = 'a'\n[tools.soil]\npreset = 'P1'\n"), HasSubstr("mine.toml:3"));
  EXPECT_THAT(errorOf("[[tools]]\nname = 'a'\n[tools.hand]\nreach_mm = 1e9\n"),
              HasSubstr("mine.toml:4: [tools.hand] reach_mm"));
  EXPECT_THAT(errorOf("[[tools]]\nname = 'a'\nsize_mm = [1, 2]\n"), HasSubstr("mine.toml:3: [[tools]] size_mm"));
  EXPECT_THAT(errorOf("[[tools]]\nname = 'a'\nmodel = 'rake'\nshape = 'box'\n"), HasSubstr("cannot both be given"));
  EXPECT_THAT(errorOf("tools = []\n"), HasSubstr("under [[tools]]"));
  EXPECT_THAT(errorOf(kTwo, {"tools.middle.shape=box"}), HasSubstr("one of the tools that are there: left, right"));
  EXPECT_THAT(errorOf("[bed]\nseed = 1\n", {"tools.middle.shape=box"}), HasSubstr("mine.toml has no [[tools]]"));
  EXPECT_THAT(errorOf(kTwo, {"tools.left.shape=box", "tools.left.shape=sphere"}), HasSubstr("is given twice"));
  EXPECT_THAT([] { (void)changed(with(kTwo), Texts{"tools.middle.shape=box"}); },
              testing::ThrowsMessage<InvalidParameter>(HasSubstr("one of left, right")));
}

TEST(SceneTools, AWheelHasGrousersRoundItsRim) {
  const SceneFile scene = with(
      "[[tool_part]]\nshape = 'cylinder'\ndiameter_mm = 20\nlength_mm = 10\n"
      "[[tool_part]]\nsize_mm = [8, 3, 10]\nat_mm = [12, 0, 0]\ncopies = 4\n");
  const ToolMesh& mesh = *scene.tool.mesh;
  EXPECT_NEAR(mesh.field.corners().high_m.x(), 0.016, 1e-5);
  EXPECT_NEAR(mesh.field.corners().high_m.y(), 0.016, 1e-5);
  EXPECT_NEAR(mesh.field.corners().low_m.y(), -0.016, 1e-5);
  EXPECT_THAT(errorOf("[[tool_part]]\ncopies = 60\n[[tool_part]]\ncopies = 5\n"), HasSubstr("65"));
  EXPECT_THAT(errorOf("[[tool_part]]\ncopies = 0\n"), HasSubstr("1 to 64"));
}

TEST(SceneTools, EachHasItsOwnDevice) {
  const std::string two = "[device]\nkind = 'network'\n[[tools]]\nname = 'a'\n[[tools]]\nname = 'b'\n";
  EXPECT_THAT(errorOf(two), HasSubstr("of two tools"));
  EXPECT_EQ(with(two + "[tools.device]\naddress = '127.0.0.1:9051'\n").more_tools.front().device.kind,
            DeviceKind::kNetwork);
  std::string five = "[device]\nkind = 'network'\n";
  for (const std::string name : {"a", "b", "c", "d", "e"}) {
    five += "[[tools]]\nname = '" + name + "'\n[tools.device]\nid = '" + name + "'\n";
  }
  EXPECT_THAT(errorOf(five), HasSubstr("at most 4"));
}

TEST(Joints, AreReadAndWritten) {
  const SceneFile scene = with(
      "[tool]\nshape = 'cylinder'\njoint_drive = 'torque'\njoint_axis = [0, 3, 4]\njoint_point_mm = [0, 0, 5]\n"
      "joint_torque_nm = 0.2\njoint_inertia_kg_m2 = 0.01\n");
  const Joint& joint = scene.tool.joint;
  EXPECT_EQ(joint.drive, Drive::kTorque);
  EXPECT_EQ(joint.axis, Vec3(0, 0.6, 0.8));
  EXPECT_EQ(joint.point_m, Vec3(0, 0, 0.005));
  EXPECT_EQ(joint.torque_nm, 0.2);
  EXPECT_EQ(joint.inertia_kg_m2, 0.01);
  EXPECT_TRUE(loadSceneFileText(sceneFileText(scene), "the recorded scene") == scene);
}

TEST(Joints, RefuseNonsense) {
  const std::string drive = "[tool]\njoint_drive = 'speed'\n";
  EXPECT_THAT(errorOf(drive), HasSubstr("mine.toml:2: [tool] joint_drive = 'speed' needs [tool] joint_axis"));
  EXPECT_THAT(errorOf(drive + "joint_axis = [0, 0, 0]\n"), HasSubstr("a direction, for example"));
  EXPECT_THAT(errorOf(drive + "joint_axis = [0, 0, 1]\njoint_speed_rad_s = 1e9\n"), HasSubstr("must be -100 to 100"));
  EXPECT_THAT(errorOf("[tool]\njoint_drive = 'free'\njoint_axis = [0, 0, 1]\n"),
              HasSubstr("needs [tool] joint_inertia_kg_m2"));
  EXPECT_THAT(errorOf("[tool]\njoint_drive = 'petrol'\n"), HasSubstr("none, speed, torque or free"));
}

TEST(Hand, MayHoldATurnedTool) {
  const SceneFile scene = with("[hand]\nturn_deg = [90, 0, 0]\n");
  EXPECT_DOUBLE_EQ(scene.hand.turn_rad.x(), std::numbers::pi / 2);
}

}  // namespace
}  // namespace haptolith
