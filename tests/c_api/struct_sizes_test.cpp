// Structs that begin with `size`: every size from that of the first version on is served, and nothing beyond it
// touched.

#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>

#include "device.h"
#include "struct_memory.h"
#include "use.h"

namespace haptolith::library {
namespace {

TEST(StructSizes, WhatTheLibraryFillsInMayBeOlderOrNewer) {
  const ScenePtr scene = sceneOf(kIcra2021);
  hapto_result* made_result = nullptr;
  const SoilPtr soil = soilOf("lunar-0-15cm");
  expectOk(hapto_soil_profile(soil.get(), 1.62, 0.1, &made_result));
  const ResultPtr result(made_result);
  (void)hapto_scene_from_toml("[bed]\nthreads = 0\n", nullptr, nullptr, 0, nullptr, nullptr, nullptr);

  expectFilledIn<hapto_error>("hapto_error", 40, [](hapto_error* out) { return hapto_last_error(out); });
  expectFilledIn<hapto_scene_info>("hapto_scene_info", 144,
                                   [&](hapto_scene_info* out) { return hapto_scene_get_info(scene.get(), out); });
  expectFilledIn<hapto_tool_state>(
      "hapto_tool_state", 304, [&](hapto_tool_state* out) { return hapto_scene_tool_get_state(scene.get(), 0, out); });
  expectFilledIn<hapto_array>("hapto_array, view", 32,
                              [&](hapto_array* out) { return hapto_scene_view(scene.get(), HAPTO_POSITION, out); });
  expectFilledIn<hapto_array>("hapto_array, column", 32,
                              [&](hapto_array* out) { return hapto_result_column(result.get(), "depth_m", out); });

  OwnDevice own;
  const hapto_device device = own.handle(true);
  hapto_loop* made = nullptr;
  expectOk(hapto_loop_create(scene.get(), &device, HAPTO_LOOP_TICKED_BY_CALLER, &made));
  const LoopPtr loop(made);
  expectFilledIn<hapto_snapshot>("hapto_snapshot", 248,
                                 [&](hapto_snapshot* out) { return hapto_loop_snapshot(loop.get(), out); });

  hapto_safety* safety = nullptr;
  expectOk(hapto_safety_create(&device.limits, nullptr, 0, 1e-3, 100, &safety));
  expectFilledIn<hapto_safety_info>("hapto_safety_info", 32,
                                    [&](hapto_safety_info* out) { return hapto_safety_get_info(safety, out); });
  expectOk(hapto_safety_destroy(safety));
}

/// A caller's struct in a version of it that has another size.
template <class Struct>
Memory inVersion(const Struct& value, std::uint32_t size) {
  Memory memory(size);
  std::memcpy(memory.bytes.data(), &value, std::min<std::size_t>(size, sizeof value));
  std::memcpy(memory.bytes.data(), &size, sizeof size);
  return memory;
}

TEST(StructSizes, WhatTheLibraryReadsMayBeOlderOrNewer) {
  OwnDevice own;
  const hapto_device device = own.handle(true);
  for (const std::uint32_t size : {std::uint32_t{231}, std::uint32_t{232}, 232 + kLater}) {
    SCOPED_TRACE(size);
    const ScenePtr scene = sceneOf(kIcra2021);
    Memory given = inVersion(device, size);
    hapto_loop* loop = nullptr;
    ASSERT_EQ(hapto_loop_create(scene.get(), given.as<hapto_device>(), HAPTO_LOOP_TICKED_BY_CALLER, &loop),
              size < 232 ? HAPTO_WRONG_SIZE : HAPTO_OK);
    if (loop != nullptr) {
      EXPECT_EQ(hapto_loop_tick(loop, 0), HAPTO_OK);
      expectOk(hapto_loop_destroy(loop));
    }
  }
  for (const std::uint32_t size : {std::uint32_t{175}, std::uint32_t{176}, 176 + kLater}) {
    SCOPED_TRACE(size);
    Memory limits = inVersion(device.limits, size);
    hapto_safety* safety = nullptr;
    ASSERT_EQ(hapto_safety_create(limits.as<hapto_device_limits>(), nullptr, 0, 1e-3, 100, &safety),
              size < 176 ? HAPTO_WRONG_SIZE : HAPTO_OK);
    if (safety == nullptr) {
      continue;
    }
    hapto_device_input input{};
    input.pose.orientation[0] = 1;
    Memory older = inVersion(input, 127);
    auto output = sized<hapto_device_output>();
    EXPECT_EQ(hapto_safety_step(safety, older.as<hapto_device_input>(), 0, &output), HAPTO_WRONG_SIZE);
    Memory newer = inVersion(input, 128 + kLater);
    EXPECT_EQ(hapto_safety_step(safety, newer.as<hapto_device_input>(), 0, &output), HAPTO_OK);
    Memory small_output = inVersion(output, 63);
    EXPECT_EQ(hapto_safety_step(safety, newer.as<hapto_device_input>(), 0, small_output.as<hapto_device_output>()),
              HAPTO_WRONG_SIZE);
    Memory large_output = inVersion(output, 64 + kLater);
    EXPECT_EQ(hapto_safety_step(safety, newer.as<hapto_device_input>(), 0, large_output.as<hapto_device_output>()),
              HAPTO_OK);
    EXPECT_EQ(large_output.bytes[64], kUntouched);
    expectOk(hapto_safety_destroy(safety));
  }
}

}  // namespace
}  // namespace haptolith::library
