#include <gmock/gmock.h>

#include <cstring>
#include <string>
#include <vector>

#include "use.h"

namespace haptolith::library {
namespace {

using testing::HasSubstr;

std::string stateOf(const hapto_scene* scene) {
  std::uint64_t needed = 0;
  EXPECT_EQ(hapto_scene_get_state(scene, nullptr, 0, &needed), HAPTO_TOO_SMALL);
  std::string bytes(needed, '\0');
  expectOk(hapto_scene_get_state(scene, bytes.data(), bytes.size(), &needed));
  return bytes;
}

ScenePtr sceneFrom(const std::string& bytes) {
  hapto_scene* scene = nullptr;
  expectOk(hapto_scene_from_state(bytes.data(), bytes.size(), &scene));
  return ScenePtr(scene);
}

struct Case {
  const char* name;
  const char* toml;
  const char* override;
};
class GoesOn : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Scenes, GoesOn,
    testing::Values(
        Case{"Icra2021", kIcra2021, "bed.sleep=true"}, Case{"Icra2021ThatDoesNotSleep", kIcra2021, "bed.sleep=false"},
        Case{"Contact", kContact, "bed.sleep=true"},
        Case{"ContactThatFallsAsleepSoon", kContact, "bed.sleep_speed_m_s=0.01"},
        Case{"Settled",
             "[soil]\nname = 'lunar-0-15cm'\nradius_mm = 6\n[bed]\nstart = 'settled'\nwidth_mm = 150\nlength_mm = 120\n"
             "depth_mm = 40\n",
             "bed.seed=2"},
        Case{"Rain", "[bed]\nstart = 'rain'\nparticles = 200\n", "bed.seed=3"},
        Case{"Jaws", kContact, "tool.shape=jaws"}),
    [](const auto& param) { return param.param.name; });

TEST_P(GoesOn, ClonedSavedAndRestoredScenesGoOnWithTheSameBits) {
  const ScenePtr scene = sceneOf(GetParam().toml, {GetParam().override});
  stir(scene.get(), 0, 400);
  hapto_scene* copy = nullptr;
  expectOk(hapto_scene_clone(scene.get(), &copy));
  const ScenePtr clone(copy);
  const std::string bytes = stateOf(scene.get());
  const ScenePtr saved = sceneFrom(bytes);
  const ScenePtr elsewhere = sceneOf(GetParam().toml, {GetParam().override});
  stir(elsewhere.get(), 100, 300);
  expectOk(hapto_scene_set_state(elsewhere.get(), bytes.data(), bytes.size()));
  EXPECT_EQ(stateOf(clone.get()), bytes);
  EXPECT_EQ(stateOf(saved.get()), bytes);
  EXPECT_EQ(stateOf(elsewhere.get()), bytes);
  for (int tick = 400; tick < 1400; tick += 25) {
    const double felt = stir(scene.get(), tick, tick + 25);
    const std::uint64_t hash = hashOf(scene.get());
    for (const ScenePtr* other : {&clone, &saved, &elsewhere}) {
      ASSERT_EQ(stir(other->get(), tick, tick + 25), felt) << tick;
      ASSERT_EQ(hashOf(other->get()), hash) << tick;
    }
  }
}

TEST(LibraryState, ChangesOfSoilGravityAndToolAreInIt) {
  const ScenePtr scene = sceneOf(kContact);
  const std::vector<const char*> changes{"gravity.body=Mars", "soil.contact_cohesion_n=0", "tool.size_mm=[30, 30, 4]"};
  expectOk(hapto_scene_change(scene.get(), changes.data(), static_cast<std::uint32_t>(changes.size())));
  stir(scene.get(), 0, 300);
  const std::string bytes = stateOf(scene.get());
  const ScenePtr saved = sceneFrom(bytes);
  const ScenePtr other = sceneOf(kContact);
  expectOk(hapto_scene_set_state(other.get(), bytes.data(), bytes.size()));
  const double felt = stir(scene.get(), 300, 900);
  EXPECT_EQ(stir(saved.get(), 300, 900), felt);
  EXPECT_EQ(stir(other.get(), 300, 900), felt);
  EXPECT_EQ(hashOf(saved.get()), hashOf(scene.get()));
  EXPECT_EQ(hashOf(other.get()), hashOf(scene.get()));
}

TEST(LibraryState, OfASceneThatNobodyHasTouchedIsAStateToo) {
  const ScenePtr scene = sceneOf(kIcra2021);
  hapto_pose pose{};
  expectOk(hapto_scene_get_tool_pose(scene.get(), &pose));
  EXPECT_EQ(pose.orientation[0], 1);
  EXPECT_EQ(pose.orientation[1], 0);
  hapto_scene_info info{};
  info.size = sizeof info;
  expectOk(hapto_scene_get_info(scene.get(), &info));
  EXPECT_GT(pose.position_m[2], info.surface_m + 0.05) << "above the soil";
  const std::string bytes = stateOf(scene.get());
  stir(scene.get(), 0, 300);
  const std::uint64_t first = hashOf(scene.get());
  expectOk(hapto_scene_set_state(scene.get(), bytes.data(), bytes.size()));
  stir(scene.get(), 0, 300);
  EXPECT_EQ(hashOf(scene.get()), first);
}

TEST(LibraryState, IsTheSameForAnyNumberOfThreads) {
  const ScenePtr one = sceneOf(kContact, {"bed.threads=1"});
  const ScenePtr two = sceneOf(kContact, {"bed.threads=2"});
  stir(one.get(), 0, 200);
  const std::string bytes = stateOf(one.get());
  expectOk(hapto_scene_set_state(two.get(), bytes.data(), bytes.size()));
  std::string text(100'000, '\0');
  expectOk(hapto_scene_get_toml(two.get(), text.data(), text.size(), nullptr));
  EXPECT_THAT(text, HasSubstr("threads = 2"));
  EXPECT_EQ(stir(one.get(), 200, 500), stir(two.get(), 200, 500));
  EXPECT_EQ(hashOf(one.get()), hashOf(two.get()));
}

TEST(LibraryState, BringsACollapsedSceneBack) {
  const ScenePtr scene = sceneOf(kIcra2021, {"soil.stiffness_n_m=8"});
  const std::string good = stateOf(scene.get());
  const double crushing[3] = {-577, -577, -577};  // so soft a soil is crushed into a corner
  expectOk(hapto_scene_set_gravity(scene.get(), crushing));
  const hapto_pose above{{0, 0, 0.3}, {1, 0, 0, 0}};
  std::int32_t status = HAPTO_OK;
  for (int tick = 0; tick < 3000 && status == HAPTO_OK; ++tick) {
    status = hapto_scene_step(scene.get(), &above, nullptr, nullptr);
  }
  ASSERT_TRUE(status == HAPTO_COLLAPSED || status == HAPTO_NOT_FINITE) << status;
  EXPECT_EQ(hapto_scene_step(scene.get(), &above, nullptr, nullptr), status) << "and it stays so";
  hapto_loop* loop = nullptr;
  EXPECT_EQ(hapto_loop_create(scene.get(), nullptr, 0, &loop), status);
  expectOk(hapto_scene_set_state(scene.get(), good.data(), good.size()));
  EXPECT_GT(stir(scene.get(), 0, 600), 1);
}

TEST(LibraryState, OfAnotherSceneIsRefused) {
  const ScenePtr scene = sceneOf(kIcra2021);
  stir(scene.get(), 0, 100);
  const std::uint64_t before = hashOf(scene.get());
  for (const ScenePtr& other :
       {sceneOf(kContact), sceneOf(kIcra2021, {"bed.particles=200"}), sceneOf(kIcra2021, {"bed.width_mm=140"})}) {
    const std::string bytes = stateOf(other.get());
    EXPECT_EQ(hapto_scene_set_state(scene.get(), bytes.data(), bytes.size()), HAPTO_INVALID_PARAMETER);
    EXPECT_THAT(lastError().message, HasSubstr("hapto_scene_from_state()"));
  }
  EXPECT_EQ(hashOf(scene.get()), before);
}

TEST(LibraryState, WhatIsDamagedIsRefused) {
  const ScenePtr scene = sceneOf(kIcra2021);
  const std::string good = stateOf(scene.get());
  hapto_scene* made = nullptr;
  const auto refused = [&](const std::string& bytes) {
    const std::int32_t from = hapto_scene_from_state(bytes.data(), bytes.size(), &made);
    const std::int32_t set = hapto_scene_set_state(scene.get(), bytes.data(), bytes.size());
    return from == HAPTO_FAILURE && set == HAPTO_FAILURE;
  };
  EXPECT_TRUE(refused("nonsense"));
  EXPECT_TRUE(refused(good.substr(0, good.size() - 1)));
  EXPECT_TRUE(refused(good + "x"));
  for (std::size_t at = 0; at < good.size(); at += 997) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x40);
    EXPECT_TRUE(refused(bytes)) << at;
  }
  std::string other_version = good;
  other_version[9] = 9;
  EXPECT_TRUE(refused(other_version));
  EXPECT_THAT(lastError().message, HasSubstr("was saved by version"));
  std::string other_machine = good;
  std::memcpy(other_machine.data() + 16, "ABACUS\0", 7);
  EXPECT_TRUE(refused(other_machine));
  EXPECT_THAT(lastError().message, HasSubstr("with ABACUS arithmetic"));
  EXPECT_EQ(stateOf(scene.get()), good);
}

}  // namespace
}  // namespace haptolith::library
