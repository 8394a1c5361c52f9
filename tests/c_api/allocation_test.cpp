// What may be called at 1 kHz allocates nothing, neither in the library nor here.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "../counted_new.h"
#include "device.h"
#include "use.h"

namespace haptolith::library {
namespace {

TEST(LibraryAtOneKilohertz, AllocatesNothing) {
  for (const char* toml : {kIcra2021, kContact}) {
    const ScenePtr scene = sceneOf(toml);
    ASSERT_GT(allocations, 0) << "the library's own are not counted: this test sees nothing";
    const long before = allocations;
    hapto_array array{};
    array.size = sizeof array;
    hapto_wrench felt{};
    double k[9];
    const double down[3]{0, 0, -1.6};
    std::int32_t worst = HAPTO_OK;
    for (int tick = 0; tick < 1500; ++tick) {
      const hapto_pose pose = stirring(tick);
      worst |= hapto_scene_step(scene.get(), &pose, nullptr, &felt);
      worst |= hapto_scene_get_wrench(scene.get(), &felt);
      worst |= hapto_scene_get_contact_stiffness(scene.get(), k);
      worst |= hapto_scene_view(scene.get(), HAPTO_POSITION, &array);
      worst |= tick == 700 ? hapto_scene_set_gravity(scene.get(), down) : 0;
      worst |= hapto_scene_set_tool_fade(scene.get(), 1);
    }
    EXPECT_EQ(hapto_scene_step(scene.get(), nullptr, nullptr, &felt), HAPTO_NULL);
    EXPECT_EQ(allocations, before);
    EXPECT_EQ(worst, HAPTO_OK);
  }
}

TEST(LibraryAtOneKilohertz, SeveralToolsAllocateNothing) {
  const ScenePtr scene = sceneOf(
      "[[tools]]\nname = 'left'\n[[tools]]\nname = 'right'\nshape = 'cylinder'\njoint_drive = 'speed'\n"
      "joint_axis = [0, 0, 1]\n",
      {"bed.particles=256"});
  auto state = sized<hapto_tool_state>();
  std::array<hapto_wrench, 2> felt{};
  const char* name = nullptr;
  std::uint32_t count = 0;
  ASSERT_GT(allocations, 0);
  const long before = allocations;
  std::int32_t worst = HAPTO_OK;
  for (int tick = 0; tick < 1000; ++tick) {
    const std::array poses{stirring(tick), stirring(tick + 250)};
    worst |= hapto_scene_step_tools(scene.get(), poses.data(), nullptr, 2, felt.data());
    worst |= hapto_scene_steps_tools(scene.get(), 1, poses.data(), nullptr, 2, felt.data(), nullptr);
    worst |= hapto_scene_tool_set_drive(scene.get(), 1, 1e-3 * tick);
    worst |= hapto_scene_tool_set_fade(scene.get(), 1, 1);
    worst |= hapto_scene_tool_set_opening(scene.get(), 1, 1);
    worst |= hapto_scene_tool_get_state(scene.get(), 1, &state);
    worst |= hapto_scene_tools(scene.get(), &count);
    worst |= hapto_scene_tool_name(scene.get(), 1, &name);
    worst |= tick == 500 ? hapto_scene_tool_place(scene.get(), 1, &poses[1]) : 0;
  }
  const hapto_pose pose = stirring(0);
  EXPECT_EQ(hapto_scene_step_tools(scene.get(), &pose, nullptr, 1, nullptr), HAPTO_WRONG_TOOL);
  EXPECT_EQ(allocations, before);
  EXPECT_EQ(worst, HAPTO_OK);
  EXPECT_GT(std::abs(state.angle_rad), 0);
}

TEST(LibraryAtOneKilohertz, ALoopOfTheCallersAllocatesNothing) {
  const ScenePtr scene = sceneOf(kContact);
  OwnDevice own;
  own.height_m = -0.1;
  const hapto_device device = own.handle(true);
  hapto_loop* made = nullptr;
  expectOk(hapto_loop_create(scene.get(), &device, 1, &made));
  const LoopPtr loop(made);
  const long before = allocations;
  std::int32_t worst = HAPTO_OK;
  for (int tick = 0; tick < 1500; ++tick) {
    worst |= hapto_loop_tick(loop.get(), 0);
  }
  EXPECT_EQ(allocations, before);
  EXPECT_EQ(worst, HAPTO_OK);
  EXPECT_GT(own.strongest_n, 0.1);
}

TEST(LibraryAtOneKilohertz, SafetyAllocatesNothingWhenItTrips) {
  hapto_device_limits limits{};
  expectOk(hapto_device_limits_init(&limits));
  hapto_safety* made = nullptr;
  expectOk(hapto_safety_create(&limits, nullptr, 0, 1e-3, 100, &made));
  const std::unique_ptr<hapto_safety, Destroy> safety(made);
  hapto_device_input told{};
  told.size = sizeof told;
  told.pose.orientation[0] = 1;
  hapto_device_output force{};
  force.size = sizeof force;
  hapto_safety_info info{};
  info.size = sizeof info;
  const long before = allocations;
  for (int tick = 0; tick < 3000; ++tick) {
    told.pose.position_m[0] = tick == 1500 ? 0.3 : 0;
    force.wrench.force_n[2] = 2;
    (void)hapto_safety_step(safety.get(), &told, 0, &force);
    (void)hapto_safety_get_info(safety.get(), &info);
  }
  EXPECT_EQ(allocations, before);
  EXPECT_GT(info.trips, 0U);
}

}  // namespace
}  // namespace haptolith::library
