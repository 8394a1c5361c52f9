#include <gmock/gmock.h>

#include <cstring>
#include <limits>
#include <vector>

#include "use.h"

namespace haptolith::library {
namespace {

TEST(LibraryBatch, GivesTheBitsOfOneByOne) {
  constexpr int kScenes = 9;
  constexpr int kTicks = 60;
  std::vector<ScenePtr> together;
  std::vector<ScenePtr> apart;
  std::vector<hapto_scene*> handles;
  std::vector<hapto_pose> poses;
  for (int i = 0; i < kScenes; ++i) {
    const std::string seed = "bed.seed=" + std::to_string(i + 1);
    together.push_back(sceneOf(i % 2 == 0 ? kIcra2021 : kContact, {seed.c_str()}));
    apart.push_back(sceneOf(i % 2 == 0 ? kIcra2021 : kContact, {seed.c_str()}));
    handles.push_back(together.back().get());
    for (int t = 0; t < kTicks; ++t) {
      poses.push_back(stirring(t + 40 * i));
    }
  }
  for (const std::uint32_t threads : {1U, 2U, 5U}) {
    hapto_batch* made = nullptr;
    expectOk(hapto_batch_create(handles.data(), kScenes, threads, &made));
    const std::unique_ptr<hapto_batch, Destroy> batch(made);
    std::vector<hapto_wrench> felt(poses.size());
    std::vector<std::int32_t> status(kScenes, -1);
    expectOk(hapto_batch_step(batch.get(), kTicks, poses.data(), nullptr, felt.data(), status.data()));
    EXPECT_THAT(status, testing::Each(HAPTO_OK));
    for (int i = 0; i < kScenes; ++i) {
      std::vector<hapto_wrench> own(kTicks);
      expectOk(hapto_scene_steps(apart[static_cast<std::size_t>(i)].get(), kTicks, poses.data() + i * kTicks, nullptr,
                                 own.data(), nullptr));
      EXPECT_EQ(std::memcmp(own.data(), felt.data() + i * kTicks, kTicks * sizeof own[0]), 0) << i;
      EXPECT_EQ(hashOf(apart[static_cast<std::size_t>(i)].get()), hashOf(together[static_cast<std::size_t>(i)].get()))
          << i;
    }
  }
}

TEST(LibraryBatch, TellsWhichSceneFailed) {
  const ScenePtr a = sceneOf(kIcra2021);
  const ScenePtr b = sceneOf(kIcra2021);
  hapto_scene* handles[]{a.get(), b.get()};
  hapto_batch* made = nullptr;
  expectOk(hapto_batch_create(handles, 2, 2, &made));
  const std::unique_ptr<hapto_batch, Destroy> batch(made);
  std::vector<hapto_pose> poses{stirring(0), stirring(0)};
  poses[1].position_m[2] = std::numeric_limits<double>::quiet_NaN();
  std::int32_t status[2]{-1, -1};
  EXPECT_EQ(hapto_batch_step(batch.get(), 1, poses.data(), nullptr, nullptr, status), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(status[0], HAPTO_OK);
  EXPECT_EQ(status[1], HAPTO_INVALID_PARAMETER);
}

TEST(LibraryBatch, RefusesOneSceneTwice) {
  const ScenePtr a = sceneOf(kIcra2021);
  hapto_scene* handles[]{a.get(), a.get()};
  hapto_batch* made = nullptr;
  EXPECT_EQ(hapto_batch_create(handles, 2, 2, &made), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(hapto_batch_create(handles, 0, 2, &made), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(hapto_batch_create(handles, 1, 1000, &made), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(made, nullptr);
}

}  // namespace
}  // namespace haptolith::library
