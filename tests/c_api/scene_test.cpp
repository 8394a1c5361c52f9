#include "haptolith/scene/scene.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "haptolith/scene_file/scene_file.h"

#include "use.h"

namespace haptolith::library {
namespace {

using testing::HasSubstr;

TEST(Library, HasTheHeadersVersion) {
  EXPECT_EQ(hapto_version(), static_cast<std::uint32_t>(HAPTO_VERSION));
  EXPECT_STREQ(hapto_version_string(), HAPTO_VERSION_STRING);
}

class EitherFriction : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Friction, EitherFriction, testing::Values(kIcra2021, kContact),
                         [](const auto& param) { return param.param == kIcra2021 ? "Icra2021" : "Contact"; });

TEST_P(EitherFriction, AStepIsAStepOfTheSceneInside) {
  const ScenePtr scene = sceneOf(GetParam());
  const SceneFile scene_file = sceneFileFromText(GetParam(), "scene");
  Scene inside(scene_file.bed, scene_file.tool);
  const auto movement = [](int tick) {
    const hapto_pose now = stirring(tick);
    const hapto_pose before = stirring(tick - 1);
    HandState hand;
    hand.pose.position_m = Vec3::Map(now.position_m);
    hand.twist.linear_m_s = (hand.pose.position_m - Vec3::Map(before.position_m)) / 1e-3;
    return hand;
  };
  inside.placeTool(movement(0));
  const hapto_pose begin = stirring(0);
  expectOk(hapto_scene_place_tool(scene.get(), &begin));
  double felt_n = 0;
  for (int tick = 1; tick < 600; ++tick) {
    ASSERT_EQ(inside.tick(movement(tick)), StepStatus::kOk);
    const hapto_pose pose = stirring(tick);
    hapto_wrench felt{};
    expectOk(hapto_scene_step(scene.get(), &pose, nullptr, &felt));
    ASSERT_EQ(Vec3::Map(felt.force_n), inside.soilWrench().force_n) << tick;
    ASSERT_EQ(Vec3::Map(felt.torque_nm), inside.soilWrench().torque_nm) << tick;
    felt_n += std::abs(felt.force_n[2]);
  }
  EXPECT_GT(felt_n, 10) << "it never dug";
  EXPECT_EQ(hashOf(scene.get()), inside.hash());
}

TEST(LibraryScene, StepsAreStepsOneByOne) {
  const ScenePtr together = sceneOf(kIcra2021);
  const ScenePtr apart = sceneOf(kIcra2021);
  std::vector<hapto_pose> poses;
  for (int tick = 0; tick < 300; ++tick) {
    poses.push_back(stirring(tick));
  }
  std::vector<hapto_wrench> felt(poses.size());
  std::uint64_t done = 0;
  expectOk(hapto_scene_steps(together.get(), poses.size(), poses.data(), nullptr, felt.data(), &done));
  EXPECT_EQ(done, poses.size());
  stir(apart.get(), 0, 300);
  EXPECT_EQ(hashOf(together.get()), hashOf(apart.get()));
  hapto_wrench last{};
  expectOk(hapto_scene_get_wrench(apart.get(), &last));
  EXPECT_EQ(std::memcmp(&last, &felt.back(), sizeof last), 0);

  poses[5].position_m[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(hapto_scene_steps(together.get(), poses.size(), poses.data(), nullptr, nullptr, &done),
            HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(done, 5U) << "those before are done";
}

TEST(LibraryScene, AWrongKeySaysWhatWouldBeRight) {
  hapto_scene* scene = nullptr;
  const auto made_with = [&](const char* override) {
    return hapto_scene_from_toml("", nullptr, &override, 1, nullptr, nullptr, &scene);
  };
  EXPECT_EQ(made_with("bed.threads=0"), HAPTO_INVALID_PARAMETER);
  EXPECT_STREQ(lastError().key, "bed.threads");
  EXPECT_STREQ(lastError().value, "0");
  EXPECT_STREQ(lastError().valid, "a whole number, 1 to 256");
  EXPECT_STREQ(lastError().message,
               "override bed.threads=0: [bed] threads = 0 is not valid: must be a whole number, 1 to 256");
  EXPECT_EQ(made_with("bed.treads=2"), HAPTO_INVALID_PARAMETER);
  EXPECT_THAT(lastError().message, HasSubstr("did you mean [bed] threads?"));
  EXPECT_EQ(made_with("threads"), HAPTO_INVALID_PARAMETER);
  EXPECT_THAT(lastError().message, HasSubstr("table.key=value"));
  EXPECT_EQ(made_with("bed.particles=3; rm"), HAPTO_INVALID_PARAMETER) << "text where a number has to be";
  EXPECT_EQ(made_with("soil.preset=P7"), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(made_with("device.library=/tmp/x.so"), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(scene, nullptr);
  EXPECT_EQ(hapto_scene_from_file("no-such-scene", nullptr, 0, nullptr, nullptr, &scene), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(hapto_scene_from_file("/no/such/file.toml", nullptr, 0, nullptr, nullptr, &scene), HAPTO_INVALID_PARAMETER);
  EXPECT_THAT(lastError().message, HasSubstr("no such file"));
  EXPECT_EQ(hapto_scene_from_toml("[bed\n", "mine.toml", nullptr, 0, nullptr, nullptr, &scene),
            HAPTO_INVALID_PARAMETER);
  EXPECT_THAT(lastError().message, HasSubstr("mine.toml:1: not TOML"));
}

TEST(LibraryScene, AnOverrideTakesThePlaceOfItsRivals) {
  const ScenePtr scene = sceneOf("[soil]\nname = 'dry-sand'\nradius_mm = 5\n[bed]\nparticles = 64\nlayers = 1\n",
                                 {"soil.preset=P1", "bed.particles = 60", "gravity.magnitude_m_s2=2"});
  hapto_scene_info info{};
  info.size = sizeof info;
  expectOk(hapto_scene_get_info(scene.get(), &info));
  EXPECT_EQ(info.particles, 60U);
  EXPECT_EQ(info.friction, 0U);
  EXPECT_DOUBLE_EQ(info.radius_m, 5e-3) << "the file's, which is none of its rivals";
  EXPECT_DOUBLE_EQ(info.gravity_m_s2[2], -2);
  EXPECT_EQ(info.steps, 0U);
  EXPECT_DOUBLE_EQ(info.tick_s, 1e-3);
}

std::int32_t giveUp(void* calls, const char* what, double /*share*/) {
  ++*static_cast<int*>(calls);
  EXPECT_STREQ(what, "soil settles");
  return 0;
}

TEST(LibraryScene, ProgressMayGiveUp) {
  hapto_scene* scene = nullptr;
  int calls = 0;
  EXPECT_EQ(
      hapto_scene_from_toml("[bed]\nstart = 'rain'\nparticles = 300\n", nullptr, nullptr, 0, giveUp, &calls, &scene),
      HAPTO_STOPPED);
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(scene, nullptr);
}

TEST(LibraryScene, ItsTextMakesTheSameScene) {
  const ScenePtr scene = sceneOf(kContact, {"bed.seed=7", "tool.shape=sphere", "tool.diameter_mm=30"});
  std::uint64_t needed = 0;
  EXPECT_EQ(hapto_scene_get_toml(scene.get(), nullptr, 0, &needed), HAPTO_TOO_SMALL);
  std::string text(needed, '\0');
  expectOk(hapto_scene_get_toml(scene.get(), text.data(), text.size(), &needed));
  EXPECT_EQ(std::strlen(text.c_str()) + 1, needed);
  const ScenePtr again = sceneOf(text.c_str());
  EXPECT_EQ(stir(scene.get(), 0, 200), stir(again.get(), 0, 200));
  EXPECT_EQ(hashOf(scene.get()), hashOf(again.get()));
}

TEST(LibraryScene, ViewsAreWhereTheParticlesAreUntilTheNextStep) {
  const ScenePtr scene = sceneOf(kIcra2021);
  const auto view = [&](std::int32_t field) {
    hapto_array array{};
    array.size = sizeof array;
    expectOk(hapto_scene_view(scene.get(), field, &array));
    return array;
  };
  const auto at = [](const hapto_array& array, std::size_t i) {
    return reinterpret_cast<const float*>(static_cast<const char*>(array.data) + i * array.stride_bytes);
  };
  stir(scene.get(), 0, 100);
  for (const std::int32_t field : {HAPTO_POSITION, HAPTO_VELOCITY}) {
    const hapto_array before = view(field);
    ASSERT_EQ(before.count, 256U);
    ASSERT_EQ(before.components, 3U);
    std::vector<float> copy(3 * before.count);
    expectOk(hapto_scene_copy(scene.get(), field, copy.data(), copy.size() * sizeof(float)));
    for (std::size_t i = 0; i < before.count; ++i) {
      ASSERT_EQ(std::memcmp(at(before, i), copy.data() + 3 * i, 3 * sizeof(float)), 0) << field << " " << i;
    }
    stir(scene.get(), 100, 101);
    const hapto_array after = view(field);
    std::vector<float> later(3 * before.count);
    expectOk(hapto_scene_copy(scene.get(), field, later.data(), later.size() * sizeof(float)));
    EXPECT_NE(copy, later);
    EXPECT_EQ(std::memcmp(at(after, 9), later.data() + 27, 3 * sizeof(float)), 0);
    volatile float old = at(before, 255)[2];  // still memory, whatever is in it
    (void)old;
  }
}

TEST(LibraryScene, CopiesTellSizesSleepAndLoads) {
  const ScenePtr scene = sceneOf(kContact);
  const hapto_pose above{{0, 0, 0.3}, {1, 0, 0, 0}};
  for (int tick = 0; tick < 1000; ++tick) {
    expectOk(hapto_scene_step(scene.get(), &above, nullptr, nullptr));
  }
  hapto_scene_info info{};
  info.size = sizeof info;
  expectOk(hapto_scene_get_info(scene.get(), &info));
  std::vector<float> radius(info.particles);
  std::vector<float> load(info.particles);
  std::vector<std::uint8_t> asleep(info.particles);
  std::vector<std::uint8_t> held(info.particles, 9);
  expectOk(hapto_scene_copy(scene.get(), HAPTO_RADIUS, radius.data(), radius.size() * 4));
  expectOk(hapto_scene_copy(scene.get(), HAPTO_CONTACT_LOAD, load.data(), load.size() * 4));
  expectOk(hapto_scene_copy(scene.get(), HAPTO_ASLEEP, asleep.data(), asleep.size()));
  expectOk(hapto_scene_copy(scene.get(), HAPTO_HELD, held.data(), held.size()));
  const auto [least, most] = std::ranges::minmax(radius);
  EXPECT_LT(least, 0.9 * info.radius_m);
  EXPECT_GT(most, 1.1 * info.radius_m);
  EXPECT_GT(std::ranges::max(load), 0);
  EXPECT_NEAR(static_cast<double>(std::ranges::count(asleep, 0)), static_cast<double>(info.awake), 16);
  EXPECT_EQ(std::ranges::count(held, 0), static_cast<std::ptrdiff_t>(info.particles));
  EXPECT_EQ(hapto_scene_copy(scene.get(), HAPTO_RADIUS, radius.data(), radius.size()), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(std::stoul(lastError().valid), radius.size() * 4);
  EXPECT_EQ(hapto_scene_copy(scene.get(), 7, radius.data(), radius.size()), HAPTO_INVALID_PARAMETER);
  hapto_array array{};
  array.size = sizeof array;
  EXPECT_EQ(hapto_scene_view(scene.get(), HAPTO_RADIUS, &array), HAPTO_INVALID_PARAMETER);
}

TEST(LibraryScene, AnImpossiblePoseMovesNothing) {
  const ScenePtr scene = sceneOf(kIcra2021);
  stir(scene.get(), 0, 50);
  const std::uint64_t before = hashOf(scene.get());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const hapto_pose& pose : {hapto_pose{{nan, 0, 0.1}, {1, 0, 0, 0}}, hapto_pose{{0, 0, 0.1}, {0, 0, 0, 0}},
                                 hapto_pose{{0, 0, 0.1}, {2, 0, 0, 0}}, hapto_pose{{0, 0, 9}, {1, 0, 0, 0}}}) {
    EXPECT_EQ(hapto_scene_step(scene.get(), &pose, nullptr, nullptr), HAPTO_INVALID_PARAMETER);
    EXPECT_EQ(hapto_scene_place_tool(scene.get(), &pose), HAPTO_INVALID_PARAMETER);
  }
  const hapto_pose good = stirring(50);
  const hapto_twist fast{{nan, 0, 0}, {0, 0, 0}};
  EXPECT_EQ(hapto_scene_step(scene.get(), &good, &fast, nullptr), HAPTO_INVALID_PARAMETER);
  const double pull[3] = {0, 0, nan};
  EXPECT_EQ(hapto_scene_set_gravity(scene.get(), pull), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(hapto_scene_set_opening(scene.get(), 1.5), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(hapto_scene_set_tool_fade(scene.get(), nan), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(hashOf(scene.get()), before);
}

TEST(LibraryScene, GravitySoilAndToolMayChangeAsTheSoilLies) {
  const ScenePtr scene = sceneOf(kContact);
  const auto changed = [&](const char* override) { return hapto_scene_change(scene.get(), &override, 1); };
  expectOk(changed("gravity.body=Mars"));
  expectOk(changed("soil.contact_friction=0.1"));
  expectOk(changed("tool.size_mm=[40, 30, 4]"));
  hapto_scene_info info{};
  info.size = sizeof info;
  expectOk(hapto_scene_get_info(scene.get(), &info));
  EXPECT_NEAR(info.gravity_m_s2[2], -3.71, 0.02);
  std::string text(100'000, '\0');
  expectOk(hapto_scene_get_toml(scene.get(), text.data(), text.size(), nullptr));
  EXPECT_THAT(text, HasSubstr("contact_friction = 0.1"));
  EXPECT_THAT(text, HasSubstr("body = \"Mars\""));
  EXPECT_EQ(changed("soil.stiffness_n_m=90000"), HAPTO_INVALID_PARAMETER) << "more steps in a tick";
  EXPECT_EQ(changed("soil.preset=P3"), HAPTO_INVALID_PARAMETER) << "another friction";
  EXPECT_EQ(changed("tool.stiffness_n_m=50000"), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(changed("bed.width_mm=200"), HAPTO_INVALID_PARAMETER);
  EXPECT_THAT(lastError().valid, HasSubstr("[soil], [gravity], [tool] and [[tools]] only"));
  EXPECT_EQ(changed("bed.threads=2"), HAPTO_INVALID_PARAMETER);
  const double sideways[3] = {1, 0, -1};
  expectOk(hapto_scene_set_gravity(scene.get(), sideways));
  expectOk(hapto_scene_get_info(scene.get(), &info));
  EXPECT_EQ(info.gravity_m_s2[0], 1);
}

TEST(LibraryScene, JawsGripWhatIsBetweenThem) {
  hapto_scene* made = nullptr;
  expectOk(hapto_scene_from_file("jaws", nullptr, 0, nullptr, nullptr, &made));
  const ScenePtr scene(made);
  hapto_scene_info info{};
  info.size = sizeof info;
  expectOk(hapto_scene_get_info(scene.get(), &info));
  const hapto_pose deep{{0, 0, info.surface_m - 0.01}, {1, 0, 0, 0}};
  expectOk(hapto_scene_place_tool(scene.get(), &deep));
  double strongest_n = 0;
  for (int tick = 0; tick < 500; ++tick) {
    expectOk(hapto_scene_set_opening(scene.get(), 1 - tick / 500.0));
    expectOk(hapto_scene_step(scene.get(), &deep, nullptr, nullptr));
    double grip_n = 0;
    expectOk(hapto_scene_get_grip_force(scene.get(), &grip_n));
    strongest_n = std::max(strongest_n, grip_n);
  }
  EXPECT_GT(strongest_n, 0.1);
  expectOk(hapto_scene_get_info(scene.get(), &info));
  EXPECT_LT(info.opening_m, 0.001);
}

TEST(LibraryScene, StiffnessTellsHowTheForceGrows) {
  const ScenePtr scene = sceneOf(kIcra2021);
  stir(scene.get(), 0, 700);
  double k[9];
  expectOk(hapto_scene_get_contact_stiffness(scene.get(), k));
  EXPECT_GT(k[8], 0) << "deeper, the soil pushes up harder";
  EXPECT_NEAR(k[1], k[3], 1e-9 * std::abs(k[8])) << "springs alone: symmetric";
}

TEST(LibraryErrors, BelongToTheThreadThatMadeThem) {
  const char* wrong = "bed.threads=0";
  hapto_scene* scene = nullptr;
  EXPECT_EQ(hapto_scene_from_toml("", nullptr, &wrong, 1, nullptr, nullptr, &scene), HAPTO_INVALID_PARAMETER);
  std::thread([] { EXPECT_EQ(lastError().status, HAPTO_OK); }).join();
  EXPECT_EQ(lastError().status, HAPTO_INVALID_PARAMETER);
}

TEST(LibraryErrors, AreCutAtWholeCharacters) {
  hapto_scene* scene = nullptr;
  for (std::string name : {"", "x"}) {  // one of them has a character of two bytes where the room ends
    for (int i = 0; i < 2000; ++i) {
      name += "ä";
    }
    EXPECT_EQ(hapto_scene_from_toml("nonsense", name.c_str(), nullptr, 0, nullptr, nullptr, &scene),
              HAPTO_INVALID_PARAMETER);
    const std::string message = lastError().message;
    EXPECT_GT(message.size(), 2040U);
    EXPECT_EQ(static_cast<unsigned char>(message.back()), 0xA4U) << "the second byte of the last character";
  }
}

}  // namespace
}  // namespace haptolith::library
