// The scenes of examples/scenes: several hands, wheels and an auger, as a user runs them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/scene_file/scene_file.h"

#include "../source_dir.h"

namespace haptolith {
namespace {

/// A scene in which every tool follows its script.
struct Running {
  explicit Running(const std::string& name)
      : scene_file(loadSceneFile(sourceDir() / "examples/scenes" / name)),
        scene(scene_file.bed, toolSet(scene_file)),
        surface_m(scene.bed().surfaceHeight()) {
    std::vector<ToolHandling> handlings;
    for (std::size_t i = 0; i < toolCount(scene_file); ++i) {
      exchangeFirst(scene_file, i);
      scene_file.hand.surface_m = surface_m;
      hands.emplace_back(scene_file.hand, scene_file.loop.tick_s);
      handlings.push_back({&hands.back(), handlingOf(scene_file, surface_m)});
      exchangeFirst(scene_file, i);
    }
    LoopParameters parameters = scene_file.loop;
    parameters.real_time = false;
    loop.emplace(scene, handlings, parameters, false);
  }

  void run(double time_s) {
    for (int tick = 0; tick < std::lround(time_s / scene_file.loop.tick_s); ++tick) {
      ASSERT_EQ(loop->tick(), LoopEnd::kRunning);
    }
  }

  SceneFile scene_file;
  Scene scene;
  double surface_m;
  std::deque<VirtualHand> hands;
  std::optional<HapticLoop> loop;
};

TEST(ExampleScenes, TheAugerDrills40mmAndLiftsCuttings) {
  Running drill("auger.toml");
  constexpr double kTip_m = 0.044;  // below the tool's middle
  drill.run(3.5);
  const double depth_m = drill.surface_m - (drill.scene.toolPose().position_m.z() - kTip_m);
  EXPECT_GT(depth_m, 0.035);
  drill.run(2.5);
  EXPECT_GT(drill.surface_m - (drill.scene.toolPose().position_m.z() - kTip_m), 0.04);
  const Bed& bed = drill.scene.bed();
  const auto* first = bed.state().position.data();
  const auto lifted = std::count_if(first, first + bed.particles(), [&](const Float4& at) {
    return at.z > drill.surface_m + 2 * bed.parameters().soil.radius_m;
  });
  EXPECT_GT(lifted, 20) << "cuttings";
  const JointState& joint = drill.scene.joint();
  EXPECT_EQ(joint.speed_rad_s, drill.scene_file.tool.joint.speed_rad_s);
}

TEST(ExampleScenes, BothHandsDig) {
  Running two("two-hands.toml");
  double strongest_n[2] = {};
  for (int tenth = 0; tenth < 20; ++tenth) {
    two.run(0.1);
    for (const std::size_t tool : {0U, 1U}) {
      strongest_n[tool] = std::max(strongest_n[tool], two.scene.soilWrench(tool).force_n.norm());
    }
  }
  EXPECT_GT(strongest_n[0], 0.5);
  EXPECT_GT(strongest_n[1], 0.5);
}

TEST(ExampleScenes, OneHandTipsItsLoadIntoTheScoopOfTheOther) {
  Running two("pass-a-load.toml");
  const auto load = [&](std::size_t tool) {
    const Bed& bed = two.scene.bed();
    const Pose& pose = two.scene.toolPose(tool);
    return std::count_if(
        bed.state().position.begin(), bed.state().position.begin() + static_cast<std::ptrdiff_t>(bed.particles()),
        [&](const Float4& at) {
          const Vec3 in_tool = pose.orientation.conjugate() * (Vec3(at.x, at.y, at.z) - pose.position_m);
          return std::abs(in_tool.x()) < 0.03 && std::abs(in_tool.y()) < 0.0225 && in_tool.z() > -0.011 &&
                 in_tool.z() < 0.02;
        });
  };
  two.run(4);
  EXPECT_GT(load(0), 40) << "lifted";
  EXPECT_EQ(load(1), 0);
  two.run(4);
  EXPECT_EQ(load(0), 0) << "tipped out";
  EXPECT_GT(load(1), 40) << "carried away";
}

TEST(ExampleScenes, TheFreeWheelTurnsOnlyAsTheSoilTurnsIt) {
  Running wheels("wheels.toml");
  wheels.run(2);
  EXPECT_EQ(wheels.scene.joint(0).speed_rad_s, 2);
  EXPECT_LT(wheels.scene.joint(2).speed_rad_s, 1.9);  // it began at 2 rad/s, in the air
  EXPECT_EQ(wheels.scene.joint(2).motor_torque_nm, 0);
}

}  // namespace
}  // namespace haptolith
