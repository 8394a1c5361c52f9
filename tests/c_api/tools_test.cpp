// Scenes with several tools.

#include <gmock/gmock.h>
#include <haptolith/haptolith.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "use.h"

namespace haptolith::library {
namespace {

using testing::HasSubstr;

/// A shovel, a sphere and a wheel in a trough of soil.
constexpr const char* kThree =
    "[bed]\nstart = 'packed'\nwidth_mm = 300\nlength_mm = 100\ndepth_mm = 50\n"
    "[[tools]]\nname = 'shovel'\n"
    "[[tools]]\nname = 'ball'\nshape = 'sphere'\ndiameter_mm = 30\n"
    "[[tools]]\nname = 'wheel'\nshape = 'cylinder'\njoint_drive = 'speed'\njoint_axis = [0, 0, 1]\n"
    "joint_speed_rad_s = 3\n";
constexpr std::uint32_t kTools = 3;
using Poses = std::array<hapto_pose, kTools>;

double surfaceOf(const hapto_scene* scene) {
  auto info = sized<hapto_scene_info>();
  expectOk(hapto_scene_get_info(scene, &info));
  return info.surface_m;
}

/// Into the soil at x, and round in a small circle.
hapto_pose dipping(double x_m, double surface_m, int tick) {
  const double t_s = 1e-3 * tick;
  return {{x_m + 0.01 * std::sin(20 * t_s), 0.01 * std::cos(20 * t_s) - 0.01,
           surface_m + 0.02 - std::min(0.035, 0.2 * t_s)},
          {1, 0, 0, 0}};
}

Poses allDipping(double surface_m, int tick) {
  return {dipping(-0.1, surface_m, tick), dipping(0, surface_m + 0.015, tick), dipping(0.1, surface_m + 0.02, tick)};
}

hapto_tool_state stateOf(const hapto_scene* scene, std::uint32_t tool) {
  auto state = sized<hapto_tool_state>();
  expectOk(hapto_scene_tool_get_state(scene, tool, &state));
  return state;
}

/// Ticks of all tools; all wrenches.
std::vector<hapto_wrench> digWithAll(hapto_scene* scene, double surface_m, int first, int last) {
  std::vector<hapto_wrench> felt;
  for (int tick = first; tick < last; ++tick) {
    const Poses poses = allDipping(surface_m, tick);
    std::array<hapto_wrench, kTools> now{};
    expectOk(hapto_scene_step_tools(scene, poses.data(), nullptr, kTools, now.data()));
    felt.insert(felt.end(), now.begin(), now.end());
  }
  return felt;
}

bool same(const hapto_wrench& a, const hapto_wrench& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

bool same(const std::vector<hapto_wrench>& a, const std::vector<hapto_wrench>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

double strongest(const std::vector<hapto_wrench>& felt, std::size_t tool) {
  double n = 0;
  for (std::size_t i = tool; i < felt.size(); i += kTools) {
    n = std::max(n, std::abs(felt[i].force_n[2]));
  }
  return n;
}

std::string stateBytes(const hapto_scene* scene) {
  std::uint64_t needed = 0;
  (void)hapto_scene_get_state(scene, nullptr, 0, &needed);
  std::string bytes(needed, '\0');
  expectOk(hapto_scene_get_state(scene, bytes.data(), bytes.size(), &needed));
  return bytes;
}

TEST(LibraryTools, HaveNumbersAndNames) {
  const ScenePtr scene = sceneOf(kThree);
  std::uint32_t count = 0;
  expectOk(hapto_scene_tools(scene.get(), &count));
  EXPECT_EQ(count, kTools);
  const char* name = nullptr;
  std::uint32_t tool = 99;
  const std::array names{"shovel", "ball", "wheel"};
  for (const std::uint32_t i : {0U, 1U, 2U}) {
    expectOk(hapto_scene_tool_name(scene.get(), i, &name));
    EXPECT_STREQ(name, names[i]);
    expectOk(hapto_scene_find_tool(scene.get(), name, &tool));
    EXPECT_EQ(tool, i);
  }
  EXPECT_EQ(hapto_scene_tool_name(scene.get(), 3, &name), HAPTO_WRONG_TOOL);
  EXPECT_EQ(hapto_scene_find_tool(scene.get(), "hoe", &tool), HAPTO_INVALID_PARAMETER);
  EXPECT_STREQ(lastError().key, "tool");
  EXPECT_STREQ(lastError().valid, "one of shovel, ball, wheel");
  const ScenePtr one = sceneOf(kIcra2021);
  expectOk(hapto_scene_tools(one.get(), &count));
  EXPECT_EQ(count, 1U);
  expectOk(hapto_scene_tool_name(one.get(), 0, &name));
  EXPECT_STREQ(name, "tool");
}

TEST(LibraryTools, SeventeenOrTwoWithOneNameAreRefusedClearly) {
  std::string many;
  for (int i = 0; i < 17; ++i) {
    many += "[[tools]]\nname = 't" + std::to_string(i) + "'\n";
  }
  hapto_scene* made = nullptr;
  EXPECT_EQ(hapto_scene_from_toml(many.c_str(), nullptr, nullptr, 0, nullptr, nullptr, &made), HAPTO_INVALID_PARAMETER);
  EXPECT_THAT(lastError().message, HasSubstr("must be at most 16"));
  EXPECT_EQ(hapto_scene_from_toml("[[tools]]\nname = 'a'\n[[tools]]\nname = 'a'\n", nullptr, nullptr, 0, nullptr,
                                  nullptr, &made),
            HAPTO_INVALID_PARAMETER);
  EXPECT_THAT(lastError().message, HasSubstr("must be another name"));
  EXPECT_EQ(made, nullptr);
}

class EachToolAlone : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Friction, EachToolAlone, testing::Values("icra2021", "contact"),
                         [](const auto& param) { return std::string(param.param); });

TEST_P(EachToolAlone, FeelsTheSameToTheBitFarFromTheOther) {
  constexpr double kApart_m = 1.2;
  const std::string bed = std::string(GetParam()) == "contact" ? "[soil]\nname = 'lunar-0-15cm'\nradius_mm = 7\n" : "";
  const std::string box = "[bed]\nstart = 'packed'\nwidth_mm = 1400\nlength_mm = 84\ndepth_mm = 40\n";
  const std::string shovel = "[[tools]]\nname = 'shovel'\n";
  const std::string ball = "[[tools]]\nname = 'ball'\nshape = 'sphere'\ndiameter_mm = 30\n";
  const ScenePtr left = sceneOf((bed + box + shovel).c_str());
  const ScenePtr right = sceneOf((bed + box + ball).c_str());
  const ScenePtr both = sceneOf((bed + box + shovel + ball).c_str());
  auto info = sized<hapto_scene_info>();
  expectOk(hapto_scene_get_info(both.get(), &info));
  const auto posesAt = [&](int tick) {
    return std::array{dipping(-kApart_m / 2, info.surface_m + 0.0025, tick),
                      dipping(kApart_m / 2, info.surface_m + 0.015, tick)};
  };
  const auto at_first = posesAt(0);
  expectOk(hapto_scene_place_tool(left.get(), &at_first[0]));
  expectOk(hapto_scene_place_tool(right.get(), &at_first[1]));
  expectOk(hapto_scene_tool_place(both.get(), 0, &at_first[0]));
  expectOk(hapto_scene_tool_place(both.get(), 1, &at_first[1]));
  // For as long as a disturbance takes from one to the other: a particle's reach in a substep.
  const int ticks = static_cast<int>((kApart_m - 0.1) / (2.5 * info.radius_m) / info.substeps);
  double felt_n = 0;
  int felt = 0;
  for (int tick = 1; felt < ticks && tick < 1000; ++tick) {
    const auto poses = posesAt(tick);
    hapto_wrench of_left{};
    hapto_wrench of_right{};
    std::array<hapto_wrench, 2> of_both{};
    expectOk(hapto_scene_step(left.get(), &poses[0], nullptr, &of_left));
    expectOk(hapto_scene_step(right.get(), &poses[1], nullptr, &of_right));
    expectOk(hapto_scene_step_tools(both.get(), poses.data(), nullptr, 2, of_both.data()));
    ASSERT_TRUE(same(of_both[0], of_left)) << tick;
    ASSERT_TRUE(same(of_both[1], of_right)) << tick;
    felt += felt > 0 || of_left.force_n[2] != 0 || of_right.force_n[2] != 0 ? 1 : 0;
    felt_n = std::max(felt_n, std::min(std::abs(of_left.force_n[2]), std::abs(of_right.force_n[2])));
  }
  EXPECT_GT(felt_n, 0.02) << "both were in the soil";
}

TEST(LibraryTools, OldCallsAreForTheFirstAndLeaveTheOthersOutOfTheSoil) {
  const ScenePtr scene = sceneOf(kThree);
  const ScenePtr alone = sceneOf("[bed]\nstart = 'packed'\nwidth_mm = 300\nlength_mm = 100\ndepth_mm = 50\n");
  const double surface_m = surfaceOf(scene.get());
  const hapto_pose before = stateOf(scene.get(), 1).scene_T_tool;
  EXPECT_GT(before.position_m[2], surface_m + 0.05) << "above the soil";
  double felt_n = 0;
  for (int tick = 0; tick < 400; ++tick) {
    const hapto_pose pose = dipping(0, surface_m, tick);
    hapto_wrench felt{};
    hapto_wrench expected{};
    expectOk(hapto_scene_step(scene.get(), &pose, nullptr, &felt));
    expectOk(hapto_scene_step(alone.get(), &pose, nullptr, &expected));
    ASSERT_TRUE(same(felt, expected)) << tick;
    felt_n = std::max(felt_n, std::abs(felt.force_n[2]));
  }
  EXPECT_GT(felt_n, 0.1);
  EXPECT_EQ(stateOf(scene.get(), 0).in_soil, 1);
  for (const std::uint32_t tool : {1U, 2U}) {
    const hapto_tool_state state = stateOf(scene.get(), tool);
    EXPECT_EQ(state.in_soil, 0);
    EXPECT_EQ(state.fade, 1) << "as soon as it is in the soil";
    EXPECT_EQ(state.soil_wrench.force_n[2], 0);
  }
  const hapto_pose after = stateOf(scene.get(), 1).scene_T_tool;
  EXPECT_EQ(std::memcmp(&after, &before, sizeof before), 0) << "where it was";

  // Placed inside the soil, the sphere is felt from the next tick on, and stays where it is.
  const hapto_pose in_soil{{-0.1, 0, surface_m - 0.01}, {1, 0, 0, 0}};
  expectOk(hapto_scene_tool_place(scene.get(), 1, &in_soil));
  EXPECT_EQ(stateOf(scene.get(), 1).in_soil, 1);
  const hapto_pose above{{0, 0, surface_m + 0.05}, {1, 0, 0, 0}};
  expectOk(hapto_scene_step(scene.get(), &above, nullptr, nullptr));
  EXPECT_GT(stateOf(scene.get(), 1).soil_wrench.force_n[2], 0.1);
  EXPECT_EQ(stateOf(scene.get(), 1).scene_T_tool.position_m[0], -0.1);
}

TEST(LibraryTools, AFadeIsKeptUntilTheToolIsInTheSoil) {
  const ScenePtr scene = sceneOf(kThree);
  const double surface_m = surfaceOf(scene.get());
  expectOk(hapto_scene_tool_set_fade(scene.get(), 1, 0));
  const hapto_pose in_soil{{-0.1, 0, surface_m - 0.01}, {1, 0, 0, 0}};
  expectOk(hapto_scene_tool_place(scene.get(), 1, &in_soil));
  const hapto_pose above{{0, 0, surface_m + 0.05}, {1, 0, 0, 0}};
  expectOk(hapto_scene_step(scene.get(), &above, nullptr, nullptr));
  EXPECT_EQ(stateOf(scene.get(), 1).soil_wrench.force_n[2], 0);
  expectOk(hapto_scene_tool_set_fade(scene.get(), 1, 0.5));
  expectOk(hapto_scene_step(scene.get(), &above, nullptr, nullptr));
  EXPECT_GT(stateOf(scene.get(), 1).soil_wrench.force_n[2], 0);
  EXPECT_EQ(stateOf(scene.get(), 1).fade, 0.5);
}

TEST(LibraryTools, StatesAreThoseOfTheOldFunctionsForTheFirst) {
  const ScenePtr scene = sceneOf(kThree);
  (void)digWithAll(scene.get(), surfaceOf(scene.get()), 0, 200);
  const hapto_tool_state state = stateOf(scene.get(), 0);
  hapto_pose pose{};
  hapto_wrench felt{};
  double k[9];
  expectOk(hapto_scene_get_tool_pose(scene.get(), &pose));
  expectOk(hapto_scene_get_wrench(scene.get(), &felt));
  expectOk(hapto_scene_get_contact_stiffness(scene.get(), k));
  EXPECT_EQ(std::memcmp(&state.scene_T_tool, &pose, sizeof pose), 0);
  EXPECT_EQ(std::memcmp(&state.scene_T_turned, &pose, sizeof pose), 0) << "it has no joint";
  EXPECT_TRUE(same(state.soil_wrench, felt));
  EXPECT_EQ(std::memcmp(state.stiffness_n_m, k, sizeof k), 0);
  EXPECT_GT(k[8], 0);
  EXPECT_EQ(state.drive, HAPTO_DRIVE_NONE);
}

TEST(LibraryTools, JointsTurnAsTheirDrivesSay) {
  const ScenePtr scene = sceneOf(kThree);
  const double surface_m = surfaceOf(scene.get());
  (void)digWithAll(scene.get(), surface_m, 0, 300);
  hapto_tool_state wheel = stateOf(scene.get(), 2);
  EXPECT_EQ(wheel.drive, HAPTO_DRIVE_SPEED);
  EXPECT_EQ(wheel.speed_rad_s, 3);
  EXPECT_NEAR(wheel.angle_rad, 0.9, 1e-9);
  EXPECT_NE(wheel.soil_torque_nm, 0);
  EXPECT_DOUBLE_EQ(wheel.motor_torque_nm, -wheel.soil_torque_nm);
  EXPECT_NEAR(wheel.scene_T_turned.orientation[3], std::sin(0.45), 1e-9);
  EXPECT_EQ(wheel.scene_T_tool.orientation[3], 0);

  expectOk(hapto_scene_tool_set_drive(scene.get(), 2, -2));
  (void)digWithAll(scene.get(), surface_m, 300, 400);
  wheel = stateOf(scene.get(), 2);
  EXPECT_EQ(wheel.speed_rad_s, -2);
  EXPECT_NEAR(wheel.angle_rad, 0.7, 1e-9);
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), 1e9}) {
    EXPECT_EQ(hapto_scene_tool_set_drive(scene.get(), 2, wrong), HAPTO_INVALID_PARAMETER);
  }
  EXPECT_EQ(hapto_scene_tool_set_drive(scene.get(), 0, 1), HAPTO_INVALID_PARAMETER) << "it has no joint";
  EXPECT_EQ(hapto_scene_tool_set_drive(scene.get(), 3, 1), HAPTO_WRONG_TOOL);

  // As an override: the same, and the angle stays.
  const char* const faster = "tools.wheel.joint_speed_rad_s=5";
  expectOk(hapto_scene_change(scene.get(), &faster, 1));
  EXPECT_NEAR(stateOf(scene.get(), 2).angle_rad, 0.7, 1e-9);
  (void)digWithAll(scene.get(), surface_m, 400, 410);
  EXPECT_NEAR(stateOf(scene.get(), 2).angle_rad, 0.75, 1e-9);

  // A torque needs an inertia that the steps bear, as in a new scene.
  const std::array<const char*, 4> torque{"tools.wheel.joint_drive='torque'", "tools.wheel.joint_axis=[0,0,1]",
                                          "tools.wheel.joint_torque_nm=0.1", "tools.wheel.joint_inertia_kg_m2=1e-12"};
  EXPECT_EQ(hapto_scene_change(scene.get(), torque.data(), torque.size()), HAPTO_INVALID_PARAMETER);
  EXPECT_THAT(lastError().message, HasSubstr("joint_inertia_kg_m2"));
}

TEST(LibraryTools, NothingMovesWhenOnePoseIsWrong) {
  const ScenePtr scene = sceneOf(kThree);
  const double surface_m = surfaceOf(scene.get());
  (void)digWithAll(scene.get(), surface_m, 0, 150);
  const std::string before = stateBytes(scene.get());
  const Poses good = allDipping(surface_m, 150);
  const auto refused = [&](const Poses& poses, const hapto_twist* twists, std::uint32_t count) {
    std::array<hapto_wrench, kTools> felt{};
    return hapto_scene_step_tools(scene.get(), poses.data(), twists, count, felt.data());
  };
  for (const std::size_t tool : {0U, 1U, 2U}) {
    Poses poses = good;
    poses[tool].position_m[1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(refused(poses, nullptr, kTools), HAPTO_INVALID_PARAMETER);
    poses = good;
    poses[tool].orientation[0] = 2;
    EXPECT_EQ(refused(poses, nullptr, kTools), HAPTO_INVALID_PARAMETER);
    poses = good;
    poses[tool].position_m[2] = 50;
    EXPECT_EQ(refused(poses, nullptr, kTools), HAPTO_INVALID_PARAMETER);
    std::array<hapto_twist, kTools> twists{};
    twists[tool].angular_rad_s[2] = std::numeric_limits<double>::infinity();
    EXPECT_EQ(refused(good, twists.data(), kTools), HAPTO_INVALID_PARAMETER);
  }
  for (const std::uint32_t count : {0U, 1U, 2U, 4U, 17U}) {
    EXPECT_EQ(refused(good, nullptr, count), HAPTO_WRONG_TOOL);
    std::uint64_t done = 9;
    EXPECT_EQ(hapto_scene_steps_tools(scene.get(), 1, good.data(), nullptr, count, nullptr, &done), HAPTO_WRONG_TOOL);
    EXPECT_EQ(done, 0U);
  }
  EXPECT_THAT(hapto_status_text(HAPTO_WRONG_TOOL), HasSubstr("not as many tools as there are poses"));
  EXPECT_EQ(hapto_scene_tool_place(scene.get(), 3, &good[0]), HAPTO_WRONG_TOOL);
  Poses nowhere = good;
  nowhere[0].position_m[0] = 9;
  EXPECT_EQ(hapto_scene_tool_place(scene.get(), 1, &nowhere[0]), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(hapto_scene_tool_set_fade(scene.get(), 1, 1.5), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(hapto_scene_tool_set_opening(scene.get(), 1, -1), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(stateBytes(scene.get()), before) << "nothing is lost";
  expectOk(refused(good, nullptr, kTools));
}

TEST(LibraryTools, ManyTicksAreTicksOneByOne) {
  const ScenePtr together = sceneOf(kThree);
  const ScenePtr apart = sceneOf(kThree);
  const double surface_m = surfaceOf(apart.get());
  std::vector<hapto_pose> poses;
  for (int tick = 0; tick < 250; ++tick) {
    const Poses now = allDipping(surface_m, tick);
    poses.insert(poses.end(), now.begin(), now.end());
  }
  std::vector<hapto_wrench> felt(poses.size());
  std::uint64_t done = 0;
  expectOk(hapto_scene_steps_tools(together.get(), 250, poses.data(), nullptr, kTools, felt.data(), &done));
  EXPECT_EQ(done, 250U);
  EXPECT_TRUE(same(felt, digWithAll(apart.get(), surface_m, 0, 250)));
  for (const std::size_t tool : {0U, 1U, 2U}) {
    EXPECT_GT(strongest(felt, tool), 0.05) << tool;
  }
  poses[3 * 7 + 1].position_m[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(hapto_scene_steps_tools(together.get(), 250, poses.data(), nullptr, kTools, nullptr, &done),
            HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(done, 7U);
}

TEST(LibraryTools, AreChangedByNameOrAllTogether) {
  const ScenePtr scene = sceneOf(kThree);
  const auto toml = [&] {
    std::string text(100'000, '\0');
    expectOk(hapto_scene_get_toml(scene.get(), text.data(), text.size(), nullptr));
    return std::string(text.c_str());
  };
  const double surface_m = surfaceOf(scene.get());
  (void)digWithAll(scene.get(), surface_m, 0, 200);
  const ScenePtr unchanged = [&] {
    hapto_scene* copy = nullptr;
    expectOk(hapto_scene_clone(scene.get(), &copy));
    return ScenePtr(copy);
  }();
  const char* const larger = "tools.ball.diameter_mm=40";
  expectOk(hapto_scene_change(scene.get(), &larger, 1));
  EXPECT_THAT(toml(), HasSubstr("diameter_mm = 40"));
  const std::vector<hapto_wrench> with = digWithAll(scene.get(), surface_m, 200, 201);
  const std::vector<hapto_wrench> without = digWithAll(unchanged.get(), surface_m, 200, 201);
  EXPECT_TRUE(same(with[0], without[0]));
  EXPECT_FALSE(same(with[1], without[1])) << "the ball has grown";
  const std::string before = stateBytes(scene.get());
  for (const char* const wrong : {"tools.hoe.diameter_mm=40", "tools.ball.name=orb", "tools.ball.hand.motion=press",
                                  "tools.ball.stiffness_n_m=100000", "tools.ball.diameter_mm=-1"}) {
    EXPECT_EQ(hapto_scene_change(scene.get(), &wrong, 1), HAPTO_INVALID_PARAMETER) << wrong;
  }
  EXPECT_EQ(stateBytes(scene.get()), before);
}

TEST(LibraryTools, ALoopMovesTheFirstAndGivesAllBack) {
  const ScenePtr scene = sceneOf(kThree, {"loop.real_time=false", "hand.motion=press"});
  const double surface_m = surfaceOf(scene.get());
  const hapto_pose in_soil{{-0.1, 0, surface_m - 0.01}, {1, 0, 0, 0}};
  expectOk(hapto_scene_tool_place(scene.get(), 1, &in_soil));
  hapto_loop* made = nullptr;
  expectOk(hapto_loop_create(scene.get(), nullptr, HAPTO_LOOP_TICKED_BY_CALLER, &made));
  for (int tick = 0; tick < 100; ++tick) {
    (void)hapto_loop_tick(made, 0);
    if (tick == 50) {
      const std::array changes{"tools.ball.diameter_mm=40", "tools.shovel.friction=0.1"};
      expectOk(hapto_loop_change(made, changes.data(), 2));
    }
  }
  expectOk(hapto_loop_destroy(made));
  EXPECT_EQ(stateOf(scene.get(), 1).soil_wrench.force_n[2], 0) << "a loop moves the first alone";
  std::string toml(100'000, '\0');
  expectOk(hapto_scene_get_toml(scene.get(), toml.data(), toml.size(), nullptr));
  EXPECT_THAT(toml, HasSubstr("diameter_mm = 40"));
  const hapto_pose above{{0, 0, surface_m + 0.05}, {1, 0, 0, 0}};
  expectOk(hapto_scene_step(scene.get(), &above, nullptr, nullptr));
  EXPECT_EQ(stateOf(scene.get(), 1).in_soil, 1);
  EXPECT_EQ(stateOf(scene.get(), 1).fade, 1);
  EXPECT_EQ(stateOf(scene.get(), 2).in_soil, 0);
  EXPECT_GT(stateOf(scene.get(), 1).soil_wrench.force_n[2], 0);
}

TEST(LibraryTools, ASavedSceneGoesOnWithTheSameBits) {
  const ScenePtr scene = sceneOf(kThree);
  const double surface_m = surfaceOf(scene.get());
  const std::string untouched = stateBytes(scene.get());
  for (int tick = 0; tick < 100; ++tick) {  // the others are not in the soil yet
    const hapto_pose pose = dipping(-0.1, surface_m, tick);
    expectOk(hapto_scene_step(scene.get(), &pose, nullptr, nullptr));
  }
  expectOk(hapto_scene_tool_set_fade(scene.get(), 1, 0.7));
  const std::vector<const char*> overrides{"tools.wheel.friction=0.4", "gravity.body=Mars"};
  expectOk(hapto_scene_change(scene.get(), overrides.data(), 2));
  expectOk(hapto_scene_tool_set_drive(scene.get(), 2, 4));
  for (const int first : {100, 250}) {
    const std::string bytes = stateBytes(scene.get());
    hapto_scene* from = nullptr;
    expectOk(hapto_scene_from_state(bytes.data(), bytes.size(), &from));
    const ScenePtr saved(from);
    hapto_scene* copy = nullptr;
    expectOk(hapto_scene_clone(scene.get(), &copy));
    const ScenePtr clone(copy);
    const ScenePtr other = sceneOf(kThree);
    (void)digWithAll(other.get(), surface_m, 0, 50);
    expectOk(hapto_scene_set_state(other.get(), bytes.data(), bytes.size()));
    EXPECT_EQ(stateBytes(saved.get()), bytes);
    EXPECT_EQ(stateBytes(clone.get()), bytes);
    EXPECT_EQ(stateBytes(other.get()), bytes);
    EXPECT_EQ(stateOf(other.get(), 1).in_soil, first == 100 ? 0 : 1);
    EXPECT_EQ(stateOf(other.get(), 1).fade, 0.7);
    const std::vector<hapto_wrench> felt = digWithAll(scene.get(), surface_m, first, first + 150);
    for (const ScenePtr* again : {&saved, &clone, &other}) {
      EXPECT_TRUE(same(digWithAll(again->get(), surface_m, first, first + 150), felt));
      EXPECT_EQ(hashOf(again->get()), hashOf(scene.get()));
    }
    EXPECT_EQ(stateOf(scene.get(), 2).speed_rad_s, 4);
  }
  expectOk(hapto_scene_set_state(scene.get(), untouched.data(), untouched.size()));
  EXPECT_EQ(stateOf(scene.get(), 2).in_soil, 0);
  EXPECT_EQ(stateBytes(scene.get()), untouched);
}

TEST(LibraryTools, AStateOfOtherToolsIsRefused) {
  const ScenePtr scene = sceneOf(kThree);
  const std::string own = stateBytes(scene.get());
  std::string renamed = kThree;
  renamed.replace(renamed.find("'ball'"), 6, "'orb'");
  for (const std::string& toml : {renamed, std::string(kThree) + "[[tools]]\nname = 'fourth'\n"}) {
    const std::string bytes = stateBytes(sceneOf(toml.c_str()).get());
    EXPECT_EQ(hapto_scene_set_state(scene.get(), bytes.data(), bytes.size()), HAPTO_INVALID_PARAMETER);
  }
  EXPECT_EQ(stateBytes(scene.get()), own);
}

TEST(LibraryTools, TheWrapperGivesTheSame) {
  hapto::Scene scene = hapto::Scene::fromToml(kThree);
  const ScenePtr plain = sceneOf(kThree);
  const double surface_m = surfaceOf(plain.get());
  ASSERT_EQ(scene.tools(), kTools);
  EXPECT_EQ(scene.toolName(2), "wheel");
  EXPECT_EQ(scene.findTool("ball"), 1U);
  const std::vector<hapto_wrench> expected = digWithAll(plain.get(), surface_m, 0, 150);
  for (int tick = 0; tick < 150; ++tick) {
    const Poses poses = allDipping(surface_m, tick);
    const std::vector<hapto_wrench> felt =
        tick % 2 == 0 ? scene.stepTools(std::vector(poses.begin(), poses.end())) : [&] {
          const auto now = scene.stepTools(poses);
          return std::vector(now.begin(), now.end());
        }();
    for (std::size_t i = 0; i < kTools; ++i) {
      ASSERT_TRUE(same(felt[i], expected[kTools * static_cast<std::size_t>(tick) + i])) << tick;
    }
  }
  EXPECT_TRUE(same(scene.toolState(1).soil_wrench, expected[expected.size() - 2]));
  scene.setDrive(2, 1);
  scene.setToolFade(1, 0.5);
  scene.setOpening(1, 0.5);
  scene.placeTool(1, {{0, 0, 0.2}, {1, 0, 0, 0}});
  EXPECT_EQ(scene.toolState(1).fade, 0.5);
  EXPECT_EQ(scene.toolState(1).scene_T_tool.position_m[2], 0.2);
  EXPECT_THAT([&] { (void)scene.stepTools(std::vector<hapto_pose>(2)); },
              testing::ThrowsMessage<hapto::Error>(HasSubstr("not as many tools as there are poses")));
  EXPECT_THAT([&] { (void)scene.findTool("hoe"); },
              testing::ThrowsMessage<hapto::Error>(HasSubstr("one of shovel, ball, wheel")));
  std::vector<hapto::Scene> scenes;
  scenes.push_back(scene.clone());
  const Poses poses = allDipping(surface_m, 150);
  const std::vector<hapto_wrench> felt = hapto::Batch(scenes, 1).stepTools(1, {poses.begin(), poses.end()});
  EXPECT_TRUE(same(felt, scene.stepTools(std::vector(poses.begin(), poses.end()))));
}

TEST(LibraryTools, ABatchStepsThemAll) {
  const ScenePtr three = sceneOf(kThree);
  const ScenePtr one = sceneOf(kIcra2021);
  const ScenePtr again = sceneOf(kThree, {"bed.seed=2"});
  const std::array apart{sceneOf(kThree), sceneOf(kIcra2021), sceneOf(kThree, {"bed.seed=2"})};
  constexpr int kTicks = 150;
  constexpr std::uint64_t kCount = 7 * kTicks;
  std::array scenes{three.get(), one.get(), again.get()};
  hapto_batch* made = nullptr;
  expectOk(hapto_batch_create(scenes.data(), 3, 2, &made));
  const std::unique_ptr<hapto_batch, Destroy> batch(made);
  const double surface_m = surfaceOf(three.get());
  std::vector<hapto_pose> poses;
  const auto add_three = [&] {
    for (int tick = 0; tick < kTicks; ++tick) {
      const Poses now = allDipping(surface_m, tick);
      poses.insert(poses.end(), now.begin(), now.end());
    }
  };
  add_three();
  for (int tick = 0; tick < kTicks; ++tick) {
    poses.push_back(stirring(tick));
  }
  add_three();
  ASSERT_EQ(poses.size(), kCount);
  std::vector<hapto_wrench> felt(kCount);
  std::array<std::int32_t, 3> status{-1, -1, -1};
  expectOk(hapto_batch_step_tools(batch.get(), kTicks, poses.data(), nullptr, kCount, felt.data(), status.data()));
  EXPECT_THAT(status, testing::Each(HAPTO_OK));
  const std::vector<hapto_wrench> first = digWithAll(apart[0].get(), surface_m, 0, kTicks);
  (void)stir(apart[1].get(), 0, kTicks);
  const std::vector<hapto_wrench> third = digWithAll(apart[2].get(), surface_m, 0, kTicks);
  EXPECT_TRUE(same({felt.begin(), felt.begin() + 3 * kTicks}, first));
  EXPECT_TRUE(same({felt.begin() + 4 * kTicks, felt.end()}, third));
  for (const std::size_t i : {0U, 1U, 2U}) {
    EXPECT_EQ(hashOf(scenes[i]), hashOf(apart[i].get())) << i;
  }
  EXPECT_EQ(hapto_batch_step_tools(batch.get(), kTicks, poses.data(), nullptr, kCount - 1, nullptr, nullptr),
            HAPTO_WRONG_TOOL);
  EXPECT_THAT(lastError().message, HasSubstr("7 tools, so 150 ticks need 1050"));
  poses[3].position_m[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(hapto_batch_step_tools(batch.get(), 1, poses.data(), nullptr, 7, nullptr, status.data()),
            HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(status[0], HAPTO_OK);
  EXPECT_EQ(status[1], HAPTO_INVALID_PARAMETER);
}

/// A hand at a place, which presses its tool into the soil.
class Presser final : public hapto::Device {
 public:
  explicit Presser(double x_m) : x_m_(x_m) {}
  const char* name() const noexcept override { return "presser"; }
  void declare(hapto_device_limits& limits) const noexcept override { limits.simulated = simulated ? 1 : 0; }
  void read(hapto_device_input& told) noexcept override {
    told.pose = {{x_m_, 0, -0.06 - 0.04 * std::min(1.0, 0.005 * reads_++)}, {1, 0, 0, 0}};
    told.state = reads_ > lost_at ? HAPTO_DEVICE_LOST : HAPTO_DEVICE_LIVE;
  }
  void write(const hapto_device_output& force) noexcept override { force_n = force.wrench.force_n[2]; }

  bool simulated = true;
  int lost_at = 1'000'000;
  double force_n = 0;

 private:
  double x_m_;
  int reads_ = 0;
};

hapto::Scene threeTools() {
  return hapto::Scene::fromToml(kThree, {"loop.real_time=false"});
}

TEST(LibraryTools, ALoopMovesEachByItsDevice) {
  hapto::Scene scene = threeTools();
  Presser left(-0.1), right(0.1);
  {
    hapto::Loop loop(scene, std::vector<hapto::Device*>{&left, nullptr, &right}, hapto::Loop::Ticked::kByCaller,
                     hapto::Loop::Ticks::kKept);
    for (int tick = 0; tick < 400; ++tick) {
      ASSERT_TRUE(loop.tick());
    }
    EXPECT_GT(left.force_n, 0);
    EXPECT_GT(right.force_n, 0);
    (void)loop.snapshot();
    EXPECT_NEAR(loop.tool(2).scene_T_tool.position_m[0], 0.1, 1e-12);
    EXPECT_GT(loop.tool(2).angle_rad, 0.9);
    EXPECT_EQ(loop.tool(2).drive, HAPTO_DRIVE_SPEED);
    const std::vector<hapto_tick> ticks = loop.takeTicks();
    ASSERT_EQ(ticks.size(), 1200U);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      ASSERT_EQ(ticks[i].tool, i % 3);
    }
    EXPECT_NEAR(ticks[1199].scene_T_tool.position_m[0], 0.1, 1e-12);
    auto state = sized<hapto_tool_state>();
    EXPECT_EQ(hapto_loop_get_tool(loop.get(), 3, &state), HAPTO_WRONG_TOOL);
  }
  EXPECT_EQ(stateOf(scene.get(), 1).in_soil, 1) << "the loop has moved it";
}

TEST(LibraryTools, ALoopLosesOneDeviceAndGoesOnWithTheOther) {
  hapto::Scene scene = threeTools();
  Presser left(-0.1), right(0.1), script(0);
  left.simulated = right.simulated = false;
  left.lost_at = 300;
  hapto::Loop loop(scene, std::vector<hapto::Device*>{&left, &script, &right}, hapto::Loop::Ticked::kByCaller);
  for (int tick = 0; tick < 900; ++tick) {
    ASSERT_TRUE(loop.tick()) << tick;
  }
  EXPECT_EQ(left.force_n, 0);
  EXPECT_GT(right.force_n, 0);
}

TEST(LibraryTools, ALoopRefusesAnotherNumberOfDevices) {
  hapto::Scene scene = threeTools();
  Presser left(-0.1), right(0.1);
  hapto_loop* made = nullptr;
  EXPECT_EQ(hapto_loop_create_tools(scene.get(), nullptr, 3, 1, &made), HAPTO_NULL);
  const hapto_device* none[3] = {};
  EXPECT_EQ(hapto_loop_create_tools(scene.get(), none, 2, 1, &made), HAPTO_WRONG_TOOL);
  EXPECT_EQ(hapto_loop_create_tools(scene.get(), none, 3, 1, nullptr), HAPTO_NULL);
  expectOk(hapto_loop_create_tools(scene.get(), none, 3, 1, &made));
  expectOk(hapto_loop_destroy(made));
}

}  // namespace
}  // namespace haptolith::library
