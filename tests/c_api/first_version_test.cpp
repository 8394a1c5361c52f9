// A program that was built with the header of haptolith 0.2.0 as of commit df114544 (first_version/) and runs with the
// library of today. use.h and device.h come with that header here.

#include <gmock/gmock.h>
#include <haptolith/recording.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "device.h"
#include "use.h"

namespace haptolith::library {
namespace {

namespace fs = std::filesystem;

static_assert(sizeof(hapto_error) == 40 && sizeof(hapto_array) == 32 && sizeof(hapto_scene_info) == 144 &&
              sizeof(hapto_device_limits) == 176 && sizeof(hapto_device_input) == 128 &&
              sizeof(hapto_device_output) == 64 && sizeof(hapto_device) == 232 && sizeof(hapto_snapshot) == 248 &&
              sizeof(hapto_tick) == 400 && sizeof(hapto_safety_info) == 32 && sizeof(hapto_recorder_info) == 56 &&
              sizeof(hapto_recording_info) == 56 && sizeof(hapto_recorded_frame) == 32 &&
              sizeof(hapto_replay_report) == 56);

/// A struct with its size in it, and memory behind it that is somebody else's.
template <class Struct>
struct Guarded {
  Guarded() {
    value.size = sizeof value;
    behind.fill(0x5A);
  }
  ~Guarded() { EXPECT_THAT(behind, testing::Each(0x5A)) << "the library wrote beyond the struct"; }
  Guarded(const Guarded&) = delete;
  Guarded& operator=(const Guarded&) = delete;

  Struct value{};
  std::array<unsigned char, 256> behind{};
};

TEST(FirstVersion, StepsAScene) {
  const ScenePtr scene = sceneOf(kIcra2021);
  EXPECT_GT(stir(scene.get(), 0, 600), 1);
  Guarded<hapto_scene_info> info;
  expectOk(hapto_scene_get_info(scene.get(), &info.value));
  EXPECT_EQ(info.value.size, sizeof info.value);
  EXPECT_EQ(info.value.particles, 256U);
  EXPECT_LT(info.value.gravity_m_s2[2], 0);
  Guarded<hapto_array> positions;
  expectOk(hapto_scene_view(scene.get(), HAPTO_POSITION, &positions.value));
  EXPECT_EQ(positions.value.count, 256U);
  EXPECT_EQ(hapto_scene_set_opening(scene.get(), 2), HAPTO_INVALID_PARAMETER);
  hapto_scene* none = nullptr;
  EXPECT_EQ(hapto_scene_from_toml("[bed]\nthreads = 0\n", nullptr, nullptr, 0, nullptr, nullptr, &none),
            HAPTO_INVALID_PARAMETER);
  Guarded<hapto_error> error;
  expectOk(hapto_last_error(&error.value));
  EXPECT_STREQ(error.value.key, "bed.threads");
}

TEST(FirstVersion, HasALoopWithADeviceOfItsOwnAndRecordsIt) {
  const fs::path file = fs::path(testing::TempDir()) / ("haptolith_first_version_" + std::to_string(getpid()) + ".h5");
  const ScenePtr scene = sceneOf(kIcra2021);
  OwnDevice own;
  own.height_m = -0.1;
  const hapto_device device = own.handle(true);
  hapto_loop* made = nullptr;
  expectOk(hapto_loop_create(scene.get(), &device,
                             HAPTO_LOOP_TICKED_BY_CALLER | HAPTO_LOOP_KEEPS_TICKS | HAPTO_LOOP_HASHES, &made));
  const LoopPtr loop(made);
  hapto_recorder* recorder = nullptr;
  expectOk(hapto_recorder_create(loop.get(), file.c_str(), 10, HAPTO_RECORDER_OVERWRITE, &recorder));
  for (int tick = 0; tick < 496; ++tick) {
    ASSERT_EQ(hapto_loop_tick(loop.get(), 0), HAPTO_OK);
  }
  Guarded<hapto_snapshot> now;
  expectOk(hapto_loop_snapshot(loop.get(), &now.value));
  EXPECT_EQ(now.value.size, sizeof now.value);
  EXPECT_EQ(now.value.running, 1);
  EXPECT_STREQ(now.value.trip, "");
  EXPECT_GT(now.value.felt.force_n[2], 0.05);
  EXPECT_EQ(now.value.position.count, 256U);

  expectOk(hapto_recorder_finish(recorder));
  Guarded<hapto_recorder_info> written;
  expectOk(hapto_recorder_get_info(recorder, &written.value));
  EXPECT_EQ(written.value.ticks, 496U);
  expectOk(hapto_recorder_destroy(recorder));

  hapto_recording* recording = nullptr;
  expectOk(hapto_recording_open(file.c_str(), &recording));
  Guarded<hapto_recording_info> info;
  expectOk(hapto_recording_get_info(recording, &info.value));
  EXPECT_EQ(info.value.ticks, 496U);
  std::vector<hapto_tick> ticks(496);
  std::uint64_t count = 0;
  expectOk(hapto_recording_read_ticks(recording, 0, ticks.data(), ticks.size(), &count));
  EXPECT_EQ(count, 496U);
  EXPECT_EQ(ticks.back().felt.force_n[2], own.last.wrench.force_n[2]);
  Guarded<hapto_recorded_frame> frame;
  expectOk(hapto_recording_read_frame(recording, 0, &frame.value, nullptr, 0));
  EXPECT_EQ(frame.value.particles, 256U);
  Guarded<hapto_replay_report> report;
  expectOk(hapto_recording_verify(recording, 0, nullptr, nullptr, &report.value));
  EXPECT_EQ(report.value.same, 1) << report.value.different;
  expectOk(hapto_recording_destroy(recording));
  fs::remove(file);
}

TEST(FirstVersion, HasASafetyLayer) {
  hapto_device_limits limits{};
  expectOk(hapto_device_limits_init(&limits));
  EXPECT_EQ(limits.size, sizeof limits);
  limits.simulated = 1;
  limits.max_force_n = 2;
  hapto_safety* safety = nullptr;
  expectOk(hapto_safety_create(&limits, nullptr, 0, 1e-3, 100, &safety));
  auto told = sized<hapto_device_input>();
  told.pose.orientation[0] = 1;
  Guarded<hapto_device_output> force;
  force.value.wrench.force_n[2] = 50;
  for (int tick = 0; tick < 200; ++tick) {
    force.value.wrench.force_n[2] = 50;
    expectOk(hapto_safety_step(safety, &told, 0, &force.value));
  }
  EXPECT_NEAR(force.value.wrench.force_n[2], 2, 1e-9);
  Guarded<hapto_safety_info> info;
  expectOk(hapto_safety_get_info(safety, &info.value));
  EXPECT_EQ(info.value.flags & HAPTO_SAFETY_SATURATED, static_cast<std::uint32_t>(HAPTO_SAFETY_SATURATED));
  expectOk(hapto_safety_destroy(safety));
}

}  // namespace
}  // namespace haptolith::library
