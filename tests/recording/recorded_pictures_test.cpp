// A run of which is kept what its bed was like at some ticks, and what a recording of it gives for these.

#include "haptolith/recording/recorded_pictures.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/bed/measure/contact_load.h"
#include "haptolith/core/error.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/recording/picture_meshes.h"
#include "haptolith/recording/recording_writer.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;
namespace fs = std::filesystem;

/// Pushes the tool into the soil and pulls it out, twice a second, and closes jaws.
class DiggingDevice final : public HapticDevice {
 public:
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] std::string_view name() const noexcept override { return "digging"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override {
    DeviceLimits limits;
    limits.workspace_radius_m = 0.2;
    limits.grips = true;
    return limits;
  }
  [[nodiscard]] DeviceInput read() noexcept override {
    const double phase = 4 * 3.14159265358979 * 1e-3 * reads_++;
    DeviceInput input;
    input.pose.position_m = Vec3(0.02 * std::sin(phase / 3), 0.003, -0.045 - 0.055 * std::sin(phase));
    input.twist.linear_m_s = Vec3(0, 0, -0.055 * 12.5 * std::cos(phase));
    input.gripper_open = 0.25;
    return input;
  }
  void write(const DeviceOutput&) noexcept override {}
  void releaseForce() noexcept override {}
  void resumeForce() noexcept override {}

 private:
  int reads_ = 0;
};

SceneFile diggingScene() {
  SceneFile scene_file;
  scene_file.bed.soil = findPreset("P3").soil;
  scene_file.device.kind = DeviceKind::kNetwork;  // any but the virtual hand
  scene_file.loop.real_time = false;
  return scene_file;
}

/// Particles of different sizes under jaws.
SceneFile jawsInUnevenSoil() {
  SceneFile scene_file = diggingScene();
  scene_file.bed.soil.friction = FrictionModel::kContact;
  scene_file.bed.soil.size_spread = 0.1;
  scene_file.tool.shape = ToolShape::kJaws;
  return scene_file;
}

std::array<float, 3> xyz(const Float4& v) {
  return {v.x, v.y, v.z};
}

constexpr int kEvery = 100;  ///< ticks between pictures
constexpr std::size_t kPictures = 5;

class RecordedPicturesTest : public testing::Test {
 protected:
  RecordedPicturesTest() : file_(fs::path(testing::TempDir()) / fmt::format("haptolith_pictures_{}.h5", getpid())) {}
  ~RecordedPicturesTest() override { fs::remove(file_); }

  /// A picture of the run as it was.
  struct Moment {
    std::vector<Float4> position, velocity;
    std::vector<float> load_n;
    Pose tool;
    double opening_m = 0;
    Wrench soil;
  };

  void record(const SceneFile& scene_file) {
    Scene scene(scene_file.bed, scene_file.tool);
    DiggingDevice device;
    HapticLoop loop(scene, device, scene_file.loop, true, handlingOf(scene_file, scene.bed().surfaceHeight()));
    loop.hashRecords();
    const std::size_t count = scene.bed().particles();
    for (std::size_t picture = 0; picture < kPictures; ++picture) {
      for (int tick = 0; tick < kEvery; ++tick) {
        ASSERT_EQ(loop.tick(), LoopEnd::kRunning);
      }
      const BedState& state = scene.bed().state();
      Moment now{.position = {state.position.begin(), state.position.begin() + static_cast<std::ptrdiff_t>(count)},
                 .velocity = {state.velocity.begin(), state.velocity.begin() + static_cast<std::ptrdiff_t>(count)},
                 .load_n = {},
                 .tool = scene.toolPose(),
                 .opening_m = scene.opening(),
                 .soil = scene.soilWrench()};
      now.load_n = contactLoads(scene_file.bed, now.position);
      ParticleFrame frame{.time_s = loop.time(), .tick = (picture + 1) * kEvery, .position_m = {}};
      for (const Float4& position : now.position) {
        frame.position_m.push_back(xyz(position));
      }
      moments_.push_back(std::move(now));
      frames_.push_back(std::move(frame));
    }
    loop.takeRecords(ticks_);
    header_.scene_file = sceneFileText(scene_file);
    header_.arithmetic = arithmetic();
    header_.device = device.name();
    header_.device_limits = limitsText(device.limits(), device.simulated());
    header_.hashed_parts = loop.hashedParts();
  }

  void write() const {
    RecordingWriter writer(file_, header_, {.overwrite = true});
    writer.add(ticks_);
    for (const ParticleFrame& frame : frames_) {
      writer.add(frame);
    }
  }

  struct Taken {
    std::vector<ScenePicture> pictures;
    std::size_t replayed = 0;
    std::string why_not_replayed;
  };
  [[nodiscard]] Taken taken(bool replay) const {
    write();
    const RecordingReader reader(file_);
    RecordedPictures pictures(reader, {.replay = replay, .settling = {}, .reached = {}});
    Taken taken;
    pictures.forEach([&](const ScenePicture& picture) { taken.pictures.push_back(picture); });
    taken.replayed = pictures.replayed();
    taken.why_not_replayed = pictures.whyNotReplayed();
    return taken;
  }

  /// All but velocities.
  void expectAsItWas(const ScenePicture& picture, std::size_t number, double radius_m) const {
    const Moment& was = moments_[number];
    EXPECT_EQ(picture.tick, (number + 1) * kEvery);
    EXPECT_DOUBLE_EQ(picture.time_s, 0.1 * static_cast<double>(number + 1));
    ASSERT_EQ(picture.position_m.size(), was.position.size());
    for (std::size_t i = 0; i < was.position.size(); ++i) {
      EXPECT_EQ(picture.position_m[i], xyz(was.position[i]));
      EXPECT_FLOAT_EQ(picture.radius_m[i], static_cast<float>(radius_m) + was.position[i].w);
    }
    EXPECT_EQ(picture.contact_force_n, was.load_n);
    ASSERT_EQ(picture.tools.size(), 1U);
    EXPECT_EQ(picture.tools.front().pose.position_m, was.tool.position_m);
    EXPECT_EQ(picture.tools.front().pose.orientation.coeffs(), was.tool.orientation.coeffs());
    EXPECT_DOUBLE_EQ(picture.tools.front().opening_m, was.opening_m);
    EXPECT_EQ(picture.tools.front().soil.force_n, was.soil.force_n);
    EXPECT_EQ(picture.tools.front().soil.torque_nm, was.soil.torque_nm);
  }

  void expectVelocitiesAsTheyWere(const ScenePicture& picture, std::size_t number) const {
    const Moment& was = moments_[number];
    double fastest_m_s = 0;
    ASSERT_EQ(picture.velocity_m_s.size(), was.velocity.size());
    for (std::size_t i = 0; i < was.velocity.size(); ++i) {
      EXPECT_EQ(picture.velocity_m_s[i], xyz(was.velocity[i])) << i;
      fastest_m_s = std::max<double>(fastest_m_s, std::abs(was.velocity[i].z));
    }
    EXPECT_GT(fastest_m_s, 0);
  }

  fs::path file_;
  RecordingHeader header_;
  std::vector<TickRecord> ticks_;
  std::vector<ParticleFrame> frames_;
  std::vector<Moment> moments_;
};

constexpr auto kIsUnknown = [](const auto& values) {
  return std::ranges::all_of(values, [](const auto& v) {
    if constexpr (std::is_floating_point_v<std::decay_t<decltype(v)>>) {
      return std::isnan(v);
    } else {
      return std::isnan(v[0]) && std::isnan(v[1]) && std::isnan(v[2]);
    }
  });
};

TEST_F(RecordedPicturesTest, AReplayGivesTheVelocitiesThatTheBedHad) {
  record(diggingScene());
  const Taken all = taken(true);
  ASSERT_EQ(all.pictures.size(), kPictures);
  EXPECT_EQ(all.replayed, kPictures);
  EXPECT_THAT(all.why_not_replayed, IsEmpty());
  for (std::size_t number = 0; number < kPictures; ++number) {
    expectAsItWas(all.pictures[number], number, diggingScene().bed.soil.radius_m);
    expectVelocitiesAsTheyWere(all.pictures[number], number);
  }
}

TEST_F(RecordedPicturesTest, AllButVelocitiesIsKnownWithoutAReplay) {
  record(jawsInUnevenSoil());
  EXPECT_NE(moments_[0].position[0].w, moments_[0].position[1].w);
  EXPECT_NEAR(moments_[0].opening_m, 0.25 * jawsInUnevenSoil().tool.opening_m, 1e-12);
  const Taken all = taken(false);
  ASSERT_EQ(all.pictures.size(), kPictures);
  EXPECT_THAT(all.why_not_replayed, IsEmpty());
  for (std::size_t number = 0; number < kPictures; ++number) {
    expectAsItWas(all.pictures[number], number, jawsInUnevenSoil().bed.soil.radius_m);
    EXPECT_THAT(all.pictures[number].velocity_m_s, IsEmpty());
  }
}

TEST_F(RecordedPicturesTest, GrainsOfSeveralSizesKeepTheirOwn) {
  SceneFile scene_file = jawsInUnevenSoil();
  scene_file.bed.width_m = scene_file.bed.length_m = 0.1;
  scene_file.bed.start = BedStart::kRain;
  scene_file.bed.particles = 100;
  scene_file.bed.grading = {
      .fine_radius_m = 0.0035, .fine_width_m = 0.02, .fine_length_m = 0.02, .fine_depth_m = 0.015};
  record(scene_file);
  EXPECT_GT(moments_[0].position.front().w, -0.001);
  EXPECT_LT(moments_[0].position.back().w, -0.003);
  ticks_[250].state_hash ^= 1;  // a replay goes no further
  for (const bool replay : {true, false}) {
    const Taken all = taken(replay);
    ASSERT_EQ(all.pictures.size(), kPictures);
    EXPECT_EQ(all.replayed, replay ? 2U : 0U);
    for (std::size_t number = 0; number < kPictures; ++number) {
      expectAsItWas(all.pictures[number], number, scene_file.bed.soil.radius_m);
    }
  }
  header_.arithmetic = "other";  // there the bed may have settled otherwise
  EXPECT_TRUE(kIsUnknown(taken(false).pictures[0].radius_m));
}

TEST_F(RecordedPicturesTest, WhereAReplayDiffersVelocitiesEndAndTheReasonIsSaid) {
  record(diggingScene());
  ticks_[250].state_hash ^= 1;
  const Taken all = taken(true);
  ASSERT_EQ(all.pictures.size(), kPictures);
  EXPECT_EQ(all.replayed, 2U);
  EXPECT_THAT(all.why_not_replayed, AllOf(HasSubstr("after 0.251 s"), HasSubstr("state_hash")));
  expectVelocitiesAsTheyWere(all.pictures[1], 1);
  for (std::size_t number = 2; number < kPictures; ++number) {
    expectAsItWas(all.pictures[number], number, diggingScene().bed.soil.radius_m);
    EXPECT_TRUE(kIsUnknown(all.pictures[number].velocity_m_s));
  }
}

TEST_F(RecordedPicturesTest, WhatSomebodyHasChangedIsNotGuessed) {
  record(diggingScene());
  ticks_[350].flags |= kTickSceneChanged;
  for (const bool replay : {true, false}) {
    const Taken all = taken(replay);
    ASSERT_EQ(all.pictures.size(), kPictures);
    expectAsItWas(all.pictures[2], 2, diggingScene().bed.soil.radius_m);
    for (std::size_t number = 3; number < kPictures; ++number) {
      const ScenePicture& picture = all.pictures[number];
      EXPECT_EQ(picture.position_m, frames_[number].position_m);
      EXPECT_EQ(picture.radius_m.size(), picture.position_m.size());
      EXPECT_TRUE(kIsUnknown(picture.radius_m));
      EXPECT_EQ(picture.contact_force_n.size(), picture.position_m.size());
      EXPECT_TRUE(kIsUnknown(picture.contact_force_n));
      EXPECT_TRUE(picture.tools.empty());
    }
    EXPECT_EQ(all.why_not_replayed, replay ? "at 0.351 s a client changed the scene" : "");
  }
}

TEST_F(RecordedPicturesTest, APictureWhoseTickIsMissingHasNoTool) {
  record(diggingScene());
  ticks_.erase(ticks_.begin() + 199);
  const Taken all = taken(true);
  ASSERT_EQ(all.pictures.size(), kPictures);
  EXPECT_EQ(all.replayed, 1U);
  EXPECT_THAT(all.why_not_replayed, HasSubstr("after 0.199 s ticks are missing"));
  EXPECT_TRUE(all.pictures[1].tools.empty());
  EXPECT_EQ(all.pictures[1].contact_force_n, moments_[1].load_n);
  expectAsItWas(all.pictures[2], 2, diggingScene().bed.soil.radius_m);
}

TEST_F(RecordedPicturesTest, ARecordingThatCannotBeReplayedGivesTheRestAndTheReason) {
  record(diggingScene());
  header_.start_tick = 3;
  EXPECT_THAT(taken(true).why_not_replayed, HasSubstr("began at tick 3"));
  header_.start_tick = 0;
  header_.arithmetic = "other";
  const Taken all = taken(true);
  EXPECT_THAT(all.why_not_replayed, HasSubstr("recorded with other arithmetic"));
  ASSERT_EQ(all.pictures.size(), kPictures);
  expectAsItWas(all.pictures[0], 0, diggingScene().bed.soil.radius_m);
  EXPECT_THAT(all.pictures[0].velocity_m_s, IsEmpty());
}

TEST_F(RecordedPicturesTest, ASceneThatCannotBeReadLeavesThePositions) {
  record(diggingScene());
  header_.scene_file = "[bed]\nfrom_the_future = 1\n";
  const Taken all = taken(false);
  ASSERT_EQ(all.pictures.size(), kPictures);
  EXPECT_EQ(all.pictures[1].position_m, frames_[1].position_m);
  EXPECT_TRUE(kIsUnknown(all.pictures[1].radius_m));
  EXPECT_TRUE(all.pictures[1].tools.empty());
}

TEST_F(RecordedPicturesTest, PositionsThatAreNoNumbersHaveNoContactForces) {
  record(diggingScene());
  frames_[1].position_m[7][2] = std::nanf("");
  const Taken all = taken(false);
  EXPECT_TRUE(kIsUnknown(all.pictures[1].contact_force_n));
  EXPECT_EQ(all.pictures[2].contact_force_n, moments_[2].load_n);
}

TEST_F(RecordedPicturesTest, WhoeverGivesUpIsHeard) {
  record(diggingScene());
  write();
  const RecordingReader reader(file_);
  for (const bool replay : {true, false}) {
    std::size_t pictures = 0;
    RecordedPictures all(reader,
                         {.replay = replay, .settling = {}, .reached = [](double time_s) { return time_s < 0.25; }});
    EXPECT_THAT([&] { all.forEach([&](const ScenePicture&) { ++pictures; }); },
                ThrowsMessage<Failure>(HasSubstr("interrupted")));
    EXPECT_EQ(pictures, 2U);
  }
}

TEST(PictureMeshes, StonesAreTheirTrianglesOrTheirSpheresWhereTheyLie) {
  StoneShape rock;
  rock.shown = {.points_m = {Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)},
                .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  StoneShape balls;
  balls.spheres = {{.centre_m = Vec3(0, 0, 0.5), .radius_m = 0.25}};
  const Pose quarter_turn{Vec3(10, 0, 0), Quat(std::sqrt(0.5), 0, 0, std::sqrt(0.5))};
  const Pose moved{Vec3(0, 5, 0), Quat::Identity()};
  const PictureMesh mesh =
      stonesMesh({{quarter_turn, std::make_shared<StoneShape>(rock)}, {moved, std::make_shared<StoneShape>(balls)}});
  ASSERT_GT(mesh.point_m.size(), 4U);
  EXPECT_NEAR(mesh.point_m[1][0], 10, 1e-6);
  EXPECT_NEAR(mesh.point_m[1][1], 1, 1e-6);
  for (std::size_t i = 4; i < mesh.point_m.size(); ++i) {
    const auto& [x, y, z] = mesh.point_m[i];
    EXPECT_NEAR((Vec3(x, y, z) - Vec3(0, 5, 0.5)).norm(), 0.25, 1e-6);
  }
  EXPECT_EQ(mesh.points_per_cell, 3U);
  EXPECT_THAT(std::vector(mesh.cells.begin() + 3, mesh.cells.begin() + 6), testing::ElementsAre(0, 1, 3));
  EXPECT_EQ(*std::min_element(mesh.cells.begin() + 12, mesh.cells.end()), 4);
  EXPECT_EQ(*std::ranges::max_element(mesh.cells), static_cast<std::int32_t>(mesh.point_m.size()) - 1);
}

}  // namespace
}  // namespace haptolith
