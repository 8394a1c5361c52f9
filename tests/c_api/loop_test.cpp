#include <gmock/gmock.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "device.h"
#include "use.h"

namespace haptolith::library {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

hapto_snapshot snapshotOf(hapto_loop* loop) {
  hapto_snapshot snapshot{};
  snapshot.size = sizeof snapshot;
  expectOk(hapto_loop_snapshot(loop, &snapshot));
  return snapshot;
}

LoopPtr loopOf(hapto_scene* scene, const hapto_device* device, bool ticked_by_caller) {
  hapto_loop* loop = nullptr;
  expectOk(hapto_loop_create(scene, device, ticked_by_caller ? 1 : 0, &loop));
  return LoopPtr(loop);
}

/// The device's zero is 85 mm above the soil.
constexpr double kInSoil_m = -0.1;

TEST(LibraryLoop, AnOwnDeviceFeelsTheSoilInALoopOfItsOwn) {
  const ScenePtr scene = sceneOf(kIcra2021);
  OwnDevice own;
  own.height_m = kInSoil_m;
  const hapto_device device = own.handle(true);
  {
    const LoopPtr loop = loopOf(scene.get(), &device, true);
    hapto_wrench felt{};
    EXPECT_EQ(hapto_scene_get_wrench(scene.get(), &felt), HAPTO_BUSY) << "it belongs to the loop";
    for (int tick = 0; tick < 1000; ++tick) {
      ASSERT_EQ(hapto_loop_tick(loop.get(), 0), HAPTO_OK);
    }
    EXPECT_EQ(own.reads, 1000);
    EXPECT_GE(own.writes, 1000);
    EXPECT_GT(own.strongest_n, 0.1);
    const hapto_snapshot snapshot = snapshotOf(loop.get());
    EXPECT_EQ(snapshot.running, 1);
    EXPECT_GT(snapshot.ticks, 900U);
    EXPECT_EQ(snapshot.position.count, 256U);
    EXPECT_STREQ(snapshot.trip, "");
    EXPECT_EQ(snapshot.misses_too_long + snapshot.misses_woken_late + snapshot.misses_preempted,
              snapshot.deadline_misses);
  }
  stir(scene.get(), 0, 10);  // given back
}

TEST(LibraryLoop, APersonsHandIsProtected) {
  const ScenePtr scene = sceneOf(kIcra2021);
  OwnDevice own;
  own.height_m = 0.02;
  const hapto_device device = own.handle(false);
  const LoopPtr loop = loopOf(scene.get(), &device, true);
  const auto ticks = [&](int count) {
    for (int tick = 0; tick < count; ++tick) {
      ASSERT_EQ(hapto_loop_tick(loop.get(), 0), HAPTO_OK);
    }
  };
  ticks(100);
  for (int i = 0; i < 1200; ++i) {  // into the soil as a hand goes
    own.height_m -= 1e-4;
    ticks(1);
  }
  EXPECT_GT(own.strongest_n, 0.05) << "the soft start has begun";
  EXPECT_STREQ(snapshotOf(loop.get()).trip, "");
  own.nan = true;
  ticks(1);
  EXPECT_EQ(own.last.wrench.force_n[2], 0) << "in the same tick";
  ticks(20);
  EXPECT_THAT(snapshotOf(loop.get()).trip, Not(HasSubstr("none")));
  EXPECT_STRNE(snapshotOf(loop.get()).trip, "");
  own.nan = false;
  ticks(200);
  EXPECT_EQ(own.last.wrench.force_n[2], 0) << "not before all has been well for a while";
  EXPECT_EQ(snapshotOf(loop.get()).trips, 1U);
  own.state = HAPTO_DEVICE_LOST;
  EXPECT_EQ(hapto_loop_tick(loop.get(), 0), HAPTO_ENDED);
  EXPECT_EQ(hapto_loop_tick(loop.get(), 0), HAPTO_ENDED);
  EXPECT_STRNE(snapshotOf(loop.get()).end, "");
  EXPECT_EQ(snapshotOf(loop.get()).running, 0);
}

TEST(LibraryLoop, RunsOnAThreadOfItsOwnAndIsWatchedAndChanged) {
  const ScenePtr scene = sceneOf(kIcra2021);
  OwnDevice own;
  own.height_m = kInSoil_m;
  const hapto_device device = own.handle(true);
  {
    const LoopPtr loop = loopOf(scene.get(), &device, false);
    EXPECT_EQ(hapto_loop_tick(loop.get(), 0), HAPTO_INVALID_PARAMETER) << "it has a thread";
    EXPECT_EQ(snapshotOf(loop.get()).position.count, 0U);
    expectOk(hapto_loop_start(loop.get()));
    EXPECT_EQ(hapto_loop_start(loop.get()), HAPTO_INVALID_PARAMETER);
    for (int i = 0; i < 500 && snapshotOf(loop.get()).ticks < 300; ++i) {
      std::this_thread::sleep_for(10ms);
    }
    EXPECT_GE(snapshotOf(loop.get()).ticks, 300U);
    const char* mars = "gravity.body=Mars";
    expectOk(hapto_loop_change(loop.get(), &mars, 1));
    const char* wide = "bed.width_mm=300";
    EXPECT_EQ(hapto_loop_change(loop.get(), &wide, 1), HAPTO_INVALID_PARAMETER);
    expectOk(hapto_loop_pause(loop.get(), 1));
    for (int i = 0; i < 500 && snapshotOf(loop.get()).paused == 0; ++i) {
      std::this_thread::sleep_for(10ms);
    }
    EXPECT_EQ(snapshotOf(loop.get()).paused, 1);
    const std::uint64_t paused_at = snapshotOf(loop.get()).ticks;
    std::this_thread::sleep_for(30ms);
    EXPECT_EQ(snapshotOf(loop.get()).ticks, paused_at);
    expectOk(hapto_loop_pause(loop.get(), 0));
    expectOk(hapto_loop_stop(loop.get()));
    EXPECT_EQ(snapshotOf(loop.get()).running, 0);
    EXPECT_STRNE(snapshotOf(loop.get()).end, "");
  }
  hapto_scene_info info{};
  info.size = sizeof info;
  expectOk(hapto_scene_get_info(scene.get(), &info));
  EXPECT_NEAR(info.gravity_m_s2[2], -3.71, 0.02);
  EXPECT_GT(own.strongest_n, 0.1);
}

TEST(LibraryLoop, TicksAreKeptForWhoeverAsksForThem) {
  const ScenePtr scene = sceneOf(kIcra2021);
  OwnDevice own;
  own.height_m = kInSoil_m;
  const hapto_device device = own.handle(true);
  hapto_loop* made = nullptr;
  expectOk(hapto_loop_create(scene.get(), &device,
                             HAPTO_LOOP_TICKED_BY_CALLER | HAPTO_LOOP_KEEPS_TICKS | HAPTO_LOOP_HASHES, &made));
  const LoopPtr loop(made);
  for (int tick = 0; tick < 300; ++tick) {
    ASSERT_EQ(hapto_loop_tick(loop.get(), 0), HAPTO_OK);
  }
  std::vector<hapto_tick> ticks(200);
  std::uint64_t count = 0;
  std::uint64_t lost = 9;
  expectOk(hapto_loop_take_ticks(loop.get(), ticks.data(), ticks.size(), &count, &lost));
  EXPECT_EQ(count, 200U);
  EXPECT_EQ(lost, 0U);
  EXPECT_NEAR(ticks[199].time_s - ticks[0].time_s, 0.199, 1e-9);
  EXPECT_EQ(ticks[5].size, sizeof(hapto_tick));
  EXPECT_NE(ticks[5].state_hash, 0U);
  EXPECT_EQ(ticks[5].device_pose.position_m[2], kInSoil_m);
  expectOk(hapto_loop_take_ticks(loop.get(), ticks.data(), ticks.size(), &count, nullptr));
  EXPECT_EQ(count, 100U);
  EXPECT_EQ(ticks[99].felt.force_n[2], own.last.wrench.force_n[2]);
  expectOk(hapto_loop_take_ticks(loop.get(), ticks.data(), ticks.size(), &count, nullptr));
  EXPECT_EQ(count, 0U);
}

TEST(LibraryLoop, GivesTheSceneBackAsItWasAskedToBe) {
  const ScenePtr scene = sceneOf(kContact);
  OwnDevice own;
  own.height_m = -0.1;
  const hapto_device device = own.handle(false);
  {
    const LoopPtr loop = loopOf(scene.get(), &device, true);
    ASSERT_EQ(hapto_loop_tick(loop.get(), 0), HAPTO_OK);
    const std::vector<const char*> changes{"gravity.body=Mars", "tool.size_mm=[30, 30, 4]",
                                           "soil.contact_friction=0.2"};
    expectOk(hapto_loop_change(loop.get(), changes.data(), 3));  // and no tick comes to them
  }
  hapto_scene_info info{};
  info.size = sizeof info;
  expectOk(hapto_scene_get_info(scene.get(), &info));
  EXPECT_EQ(info.tool_fade, 1) << "a person's tool had just begun to fade in";
  EXPECT_NEAR(info.gravity_m_s2[2], -3.71, 0.02);
  hapto_scene* made = nullptr;
  expectOk(hapto_scene_clone(scene.get(), &made));
  const ScenePtr clone(made);
  const double felt = stir(scene.get(), 0, 600);
  EXPECT_GT(felt, 1);
  EXPECT_EQ(stir(clone.get(), 0, 600), felt) << "what it is said to be is what it is";
}

TEST(LibraryLoop, AnEndedLoopCannotBeStartedAgain) {
  const ScenePtr scene = sceneOf(kIcra2021, {"loop.real_time=false", "loop.duration_s=0.01"});
  const LoopPtr loop = loopOf(scene.get(), nullptr, false);
  expectOk(hapto_loop_start(loop.get()));
  for (int i = 0; i < 500 && snapshotOf(loop.get()).running == 1; ++i) {
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(hapto_loop_start(loop.get()), HAPTO_INVALID_PARAMETER);
}

TEST(LibraryLoop, HasTheScenesOwnHandWithoutADevice) {
  const ScenePtr scene = sceneOf(kIcra2021, {"loop.real_time=false", "loop.duration_s=1.5"});
  const LoopPtr loop = loopOf(scene.get(), nullptr, false);
  expectOk(hapto_loop_start(loop.get()));
  for (int i = 0; i < 2000 && snapshotOf(loop.get()).running == 1; ++i) {
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(snapshotOf(loop.get()).running, 0);
  EXPECT_THAT(snapshotOf(loop.get()).time_s, testing::DoubleNear(1.5, 0.02));
}

TEST(LibraryLoop, AnImpossibleDeviceIsRefusedAndTheSceneGivenBack) {
  const ScenePtr scene = sceneOf(kIcra2021, {"loop.real_time=false"});
  OwnDevice own;
  hapto_loop* loop = nullptr;
  hapto_device device = own.handle(false);
  EXPECT_EQ(hapto_loop_create(scene.get(), &device, 0, &loop), HAPTO_INVALID_PARAMETER);
  EXPECT_STREQ(lastError().key, "loop.real_time");
  device = own.handle(true);
  device.limits.max_force_n = -1;
  EXPECT_EQ(hapto_loop_create(scene.get(), &device, 1, &loop), HAPTO_INVALID_PARAMETER);
  EXPECT_STREQ(lastError().key, "limits.max_force_n");
  device = own.handle(true);
  device.read = nullptr;
  EXPECT_EQ(hapto_loop_create(scene.get(), &device, 1, &loop), HAPTO_INVALID_PARAMETER);
  device = own.handle(true);
  device.size = 8;
  EXPECT_EQ(hapto_loop_create(scene.get(), &device, 1, &loop), HAPTO_WRONG_SIZE);
  device = own.handle(true);
  EXPECT_EQ(hapto_loop_create(scene.get(), &device, 8, &loop), HAPTO_INVALID_PARAMETER);
  device.limits.size = 8;
  EXPECT_EQ(hapto_loop_create(scene.get(), &device, 1, &loop), HAPTO_INVALID_PARAMETER);
  stir(scene.get(), 0, 10);
}

}  // namespace
}  // namespace haptolith::library
