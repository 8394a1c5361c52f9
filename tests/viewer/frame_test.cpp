#include "haptolith/viewer/frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <numbers>

#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/scene_file/scene_file.h"

#include "../source_dir.h"

namespace haptolith {
namespace {

const FrameSpace kSpace{Vec3(-0.1, -0.1, 0), Vec3(0.1, 0.1, 0.5)};

SceneSnapshot still(std::size_t particles, double time_s) {
  SceneSnapshot snapshot;
  snapshot.time_s = time_s;
  snapshot.asleep.resize(particles / kGroup + 1);
  snapshot.awake = particles;
  for (std::size_t i = 0; i < particles; ++i) {
    const auto share = static_cast<float>(i) / static_cast<float>(particles);
    snapshot.position.push_back({-0.1F + 0.2F * share, 0.05F, 0.1F * share, 0});
  }
  return snapshot;
}

std::string bytesOf(const char* file) {
  std::ifstream stream(sourceDir() / file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A frame taken apart by docs/reference/web-messages.md, without the encoder's help.
struct Read {
  explicit Read(const std::string& bytes) : bytes_(bytes) {
    at(2, flags), at(4, scene), at(8, time_s), at(96, tick_us), at(100, misses), at(104, awake), at(108, particles);
    at(112, runs), at(116, records), at(120, number);
    EXPECT_EQ(bytes[0], 1);
    EXPECT_EQ(bytes[1], 1);
    std::size_t end = 128 + 8 * runs + 8 * records;
    if ((flags & 16) != 0) {
      at(end, stones);
      end += 4 + 28 * stones;
    }
    tools_at = end + 4;
    if ((flags & 32) != 0) {
      at(end, tools);
      end = tools_at + 116 * tools;
    }
    EXPECT_EQ(bytes.size(), end);
    std::size_t record = 128 + 8 * runs;
    for (std::uint32_t run = 0; run < runs; ++run) {
      std::uint32_t first = 0;
      std::uint32_t count = 0;
      at(128 + 8 * run, first), at(132 + 8 * run, count);
      for (std::uint32_t i = 0; i < count; ++i, record += 8) {
        std::array<std::uint16_t, 3> q{};
        std::memcpy(q.data(), bytes.data() + record, 6);
        shown.push_back(
            {first + i, q, static_cast<std::uint8_t>(bytes[record + 6]), static_cast<std::uint8_t>(bytes[record + 7])});
      }
    }
  }
  template <class Number>
  void at(std::size_t offset, Number& value) const {
    std::memcpy(&value, bytes_.data() + offset, sizeof(value));
  }
  [[nodiscard]] float real(std::size_t offset) const {
    float value = 0;
    at(offset, value);
    return value;
  }

  struct Shown {
    std::uint32_t particle;
    std::array<std::uint16_t, 3> q;
    std::uint8_t speed, force;
  };
  const std::string& bytes_;
  std::uint16_t flags = 0;
  std::uint32_t scene = 0, misses = 0, awake = 0, particles = 0, runs = 0, records = 0, number = 0, stones = 0,
                tools = 0;
  std::size_t tools_at = 0;
  double time_s = 0;
  float tick_us = 0;
  std::vector<Shown> shown;
};

TEST(Frame, SaysHowFarJawsAreOpen) {
  SceneSnapshot snapshot = still(20, 1);
  snapshot.opening_m = 0.0625;
  FrameEncoder encoder(1, 20, kSpace);
  encoder.take(snapshot, {});
  EXPECT_EQ(Read(*encoder.frameSince(0)).real(124), 0.0625F);
}

TEST(Frame, TheFirstHoldsEveryParticleWithinHalfAStep) {
  const SceneSnapshot snapshot = still(100, 1);
  FrameEncoder encoder(3, 100, kSpace);
  encoder.take(snapshot, {});
  const auto bytes = encoder.frameSince(0);
  const Read frame(*bytes);
  EXPECT_EQ(frame.scene, 3U);
  EXPECT_EQ(frame.particles, 100U);
  EXPECT_EQ(frame.runs, 1U);
  EXPECT_EQ(frame.flags, 4);  // all particles
  ASSERT_EQ(frame.shown.size(), 100U);
  for (const Read::Shown& shown : frame.shown) {
    const Float4& p = snapshot.position[shown.particle];
    EXPECT_NEAR(-0.1 + 0.2 * shown.q[0] / 65535.0, p.x, 0.1 / 65535 * 1.01);
    EXPECT_NEAR(-0.1 + 0.2 * shown.q[1] / 65535.0, p.y, 0.1 / 65535 * 1.01);
    EXPECT_NEAR(0.5 * shown.q[2] / 65535.0, p.z, 0.25 / 65535 * 1.01);
  }
}

TEST(Frame, LaterOnesHoldOnlyTheGroupsThatChanged) {
  FrameEncoder encoder(1, 1000, kSpace);
  SceneSnapshot snapshot = still(1000, 1);
  encoder.take(snapshot, {});
  snapshot.time_s += 0.016;
  encoder.take(snapshot, {});  // speeds are known from here on
  snapshot.time_s += 0.016;
  encoder.take(snapshot, {});
  const std::uint32_t seen = encoder.number();
  snapshot.time_s += 0.016;
  snapshot.position[35].z += 0.001F;
  snapshot.position[999].z += 0.001F;
  encoder.take(snapshot, {});
  const auto bytes = encoder.frameSince(seen);
  const Read frame(*bytes);
  EXPECT_EQ(frame.flags, 0);
  EXPECT_EQ(frame.runs, 2U);
  EXPECT_EQ(frame.records, 16U + 8U);  // 32 to 47, and the last, unfinished group
  EXPECT_EQ(frame.shown[3].particle, 35U);
  EXPECT_EQ(frame.shown.back().particle, 999U);
  // 1 mm in 16 ms: 62.5 mm/s.
  EXPECT_NEAR(std::pow(10, -4 + 4 * (frame.shown[3].speed - 1) / 254.0), 0.0625, 0.0015);
  EXPECT_EQ(frame.shown[2].speed, 1);

  EXPECT_EQ(encoder.frameSince(seen), bytes) << "shared by all who have seen the same";
  const auto everything = encoder.frameSince(0);
  EXPECT_EQ(Read(*everything).records, 1000U);
  const auto nothing = encoder.frameSince(encoder.number());
  EXPECT_EQ(Read(*nothing).records, 0U);
}

TEST(Frame, WhoMissesSomeGetsAllThatChangedMeanwhile) {
  FrameEncoder encoder(1, 320, kSpace);
  SceneSnapshot snapshot = still(320, 1);
  encoder.take(snapshot, {});
  const auto first = encoder.frameSince(0);
  std::vector<std::array<std::uint16_t, 3>> client(320);
  const auto apply = [&client](const std::string& bytes) {
    for (const Read::Shown& shown : Read(bytes).shown) {
      client[shown.particle] = shown.q;
    }
  };
  apply(*first);
  std::uint32_t seen = encoder.number();
  for (int i = 1; i <= 50; ++i) {
    snapshot.time_s += 0.016;
    snapshot.position[static_cast<std::size_t>(i * 37 % 320)].x *= 0.9F;
    encoder.take(snapshot, {});
    if (i % 7 == 0) {
      apply(*encoder.frameSince(seen));
      seen = encoder.number();
    }
  }
  apply(*encoder.frameSince(seen));
  const auto whole = encoder.frameSince(0);
  for (const Read::Shown& shown : Read(*whole).shown) {
    EXPECT_EQ(client[shown.particle], shown.q) << shown.particle;
  }
}

TEST(Frame, ASceneAfterAnotherBeginsWithEverything) {
  FrameEncoder before(1, 100, kSpace);
  before.take(still(100, 1), {});
  before.take(still(100, 2), {});
  FrameEncoder after(2, 50, kSpace, before.number());
  EXPECT_FALSE(after.hasPicture());
  after.take(still(50, 3), {});
  EXPECT_TRUE(after.hasPicture());
  const auto bytes = after.frameSince(before.number());  // a client that saw all of the scene before
  const Read frame(*bytes);
  EXPECT_EQ(frame.scene, 2U);
  EXPECT_EQ(frame.records, 50U);
}

TEST(Frame, SpeedsStayWhatTheyWereWhileTimeStandsStill) {
  FrameEncoder encoder(1, 32, kSpace);
  SceneSnapshot snapshot = still(32, 1);
  encoder.take(snapshot, {});
  snapshot.time_s += 0.016;
  snapshot.position[3].z += 0.001F;
  encoder.take(snapshot, {});
  const std::uint32_t seen = encoder.number();
  const auto moving = encoder.frameSince(0);
  EXPECT_GT(Read(*moving).shown[3].speed, 100);
  encoder.take(snapshot, {});  // paused: another picture of the same moment
  const auto paused = encoder.frameSince(seen);
  EXPECT_EQ(Read(*paused).records, 0U);
}

TEST(Frame, SleepersAndForcesAndWhatLeavesTheSpace) {
  SceneSnapshot snapshot = still(32, 1);
  snapshot.asleep[1] = 1;
  snapshot.position[0] = {7, -7, -1, 0};
  std::vector<float> loads(32, 0);
  loads[2] = 1.001e-5F;
  loads[3] = 0.1F;
  loads[4] = 50;
  FrameEncoder encoder(1, 32, kSpace);
  encoder.take(snapshot, {.load_n = loads});
  const auto bytes = encoder.frameSince(0);
  const Read frame(*bytes);
  EXPECT_EQ(frame.flags, 4 + 8);
  EXPECT_EQ(frame.shown[0].q, (std::array<std::uint16_t, 3>{65535, 0, 0}));
  EXPECT_EQ(frame.shown[15].speed, 1);
  EXPECT_EQ(frame.shown[16].speed, 0);
  EXPECT_EQ(frame.shown[1].force, 0);
  EXPECT_EQ(frame.shown[2].force, 1);
  EXPECT_NEAR(std::pow(10, -5 + 6 * (frame.shown[3].force - 1) / 254.0), 0.1, 0.003);
  EXPECT_EQ(frame.shown[4].force, 255);
}

TEST(Frame, EachSaysWhereAllStonesAreAfterTheRecords) {
  SceneSnapshot snapshot = still(20, 1);
  snapshot.stones = {{Vec3(0.01, -0.02, 0.03), Quat(0.5, -0.5, 0.5, -0.5)}, {Vec3(0.04, 0, 0.05)}};
  FrameEncoder encoder(1, 20, kSpace);
  encoder.take(snapshot, {});
  const std::uint32_t seen = encoder.number();
  const auto first = encoder.frameSince(0);
  const Read whole(*first);
  EXPECT_EQ(whole.flags, 4 + 16);
  EXPECT_EQ(whole.records, 20U);
  ASSERT_EQ(whole.stones, 2U);
  const auto number = [](const Read& frame, std::size_t i) {
    return frame.real(132 + 8 * frame.runs + 8 * frame.records + 4 * i);
  };
  const std::array expected{0.01F, -0.02F, 0.03F, 0.5F, -0.5F, 0.5F, -0.5F, 0.04F, 0.0F, 0.05F, 1.0F, 0.0F, 0.0F, 0.0F};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(number(whole, i), expected[i]) << i;
  }
  snapshot.stones[1].position_m.z() = 0.06;
  encoder.take(snapshot, {});
  encoder.take(snapshot, {});  // no particle has moved
  const auto later = encoder.frameSince(seen + 1);
  const Read moved(*later);
  EXPECT_EQ(moved.records, 0U);
  ASSERT_EQ(moved.stones, 2U);
  EXPECT_EQ(number(moved, 9), 0.06F);
}

/// Two tools, of which the second is a wheel that has turned and that client 3 pulls.
SceneSnapshot withTwoTools(SceneSnapshot snapshot) {
  snapshot.tools.assign(2, {});
  snapshot.tools[0].scene_T_tool = snapshot.tools[0].turned = snapshot.scene_T_tool;
  snapshot.tools[0].opening_m = 0.0625;
  snapshot.tools[1].scene_T_tool = {Vec3(0.04, 0, 0.05)};
  snapshot.tools[1].turned = {Vec3(0.04, 0, 0.05), Quat(0.5, -0.5, 0.5, -0.5)};
  snapshot.tools[1].device_wrench_in_scene = {Vec3(4, 5, -6), Vec3(0.04, 0.05, -0.06)};
  return snapshot;
}
const std::vector<BesideTool> kBesideTwoTools{{}, {.wanted = Pose{Vec3(0.04, 0, 0.04)}, .held_by = 3}};

TEST(Frame, EachHasEveryToolAfterTheStones) {
  SceneSnapshot snapshot = withTwoTools(still(20, 1));
  snapshot.stones = {{Vec3(0.01, -0.02, 0.03)}};
  FrameEncoder encoder(1, 20, kSpace);
  encoder.take(snapshot, {.tools = kBesideTwoTools});
  const auto bytes = encoder.frameSince(0);
  const Read frame(*bytes);
  EXPECT_EQ(frame.flags, 4 + 16 + 32);
  EXPECT_EQ(frame.stones, 1U);
  ASSERT_EQ(frame.tools, 2U);
  EXPECT_EQ(frame.real(frame.tools_at + 108), 0.0625F);
  const std::size_t second = frame.tools_at + 116;
  const std::array expected{0.04F, 0.0F, 0.05F, 0.5F,  -0.5F, 0.5F,   -0.5F,         // turned
                            0.04F, 0.0F, 0.05F, 1.0F,  0.0F,  0.0F,   0.0F,          // hub
                            4.0F,  5.0F, -6.0F, 0.04F, 0.05F, -0.06F,                // wrench
                            0.04F, 0.0F, 0.04F, 1.0F,  0.0F,  0.0F,   0.0F,  0.0F};  // wanted, opening
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(frame.real(second + 4 * i), expected[i]) << i;
  }
  std::uint32_t held_by = 0;
  frame.at(second + 112, held_by);
  EXPECT_EQ(held_by, 3U);
}

TEST(Frame, HasTheFirstToolAloneUnlessAskedForAll) {
  FrameEncoder one(1, 20, kSpace);
  one.take(still(20, 1), {});
  FrameEncoder two(1, 20, kSpace);
  two.take(withTwoTools(still(20, 1)), {});
  EXPECT_EQ(*two.frameSince(0), *one.frameSince(0));
}

/// A device a quarter turn from the scene, whose handle goes along the scene's x, 15 mm below the surface.
class TurnedDevice final : public HapticDevice {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "turned"; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] DeviceLimits limits() const noexcept override {
    DeviceLimits limits;
    limits.turn_rad = Vec3(0, 0, std::numbers::pi / 2);
    return limits;
  }
  [[nodiscard]] DeviceInput read() noexcept override {
    DeviceInput input;
    input.pose.position_m = Vec3(0, 0.012 - 6e-5 * ticks_++, 0);
    input.twist.linear_m_s = Vec3(0, -0.06, 0);
    return input;
  }
  void write(const DeviceOutput& output) noexcept override { sent_ = output.wrench; }
  void releaseForce() noexcept override {}
  void resumeForce() noexcept override {}

  int ticks_ = 0;
  Wrench sent_;
};

TEST(Frame, ShowsWhatATurnedDeviceIsSentInTheScenesAxes) {
  const SceneFile icra2021;
  Scene scene(icra2021.bed, icra2021.tool);
  TurnedDevice device;
  LoopParameters loop_parameters;
  loop_parameters.real_time = false;
  HandlingParameters handling;
  handling.mapping.offset_m = Vec3(0, 0, scene.bed().surfaceHeight() - 0.015);
  HapticLoop loop(scene, device, loop_parameters, false, handling);
  while (device.ticks_ < 385) {  // the first tick, and every 16th after it, is shown
    ASSERT_EQ(loop.tick(), LoopEnd::kRunning);
  }
  (void)loop.snapshots().update();
  const SceneSnapshot& now = loop.snapshots().latest();
  EXPECT_EQ(now.device_wrench.force_n, device.sent_.force_n);
  EXPECT_EQ(now.soil_wrench.force_n, scene.soilWrench().force_n);
  FrameEncoder encoder(1, scene.bed().particles(), kSpace);
  encoder.take(now, {});
  const auto bytes = encoder.frameSince(0);
  const Read frame(*bytes);
  EXPECT_LT(frame.real(44), -0.1F) << "the hand goes along x, and the soil pushes back";
  EXPECT_NEAR(frame.real(44), -device.sent_.force_n.y(), 1e-6);
  EXPECT_NEAR(frame.real(48), device.sent_.force_n.x(), 1e-6);
  EXPECT_NEAR(frame.real(52), device.sent_.force_n.z(), 1e-6);
}

// The bytes that web/tests/unit/protocol.test.ts reads.
TEST(Frame, HasTheBytesThatThePageIsTestedWith) {
  SceneSnapshot snapshot = still(40, 12.345);
  snapshot.scene_T_tool = {Vec3(0.01, -0.02, 0.03), Quat(std::sqrt(0.5), 0, std::sqrt(0.5), 0)};
  snapshot.device_wrench_in_scene = {Vec3(1, -2, 3), Vec3(0.01, 0.02, -0.03)};
  snapshot.tick_us_lately = 17.5;
  snapshot.deadline_misses = 2;
  snapshot.awake = 32;
  snapshot.asleep[2] = 1;
  snapshot.paused = true;
  std::vector<float> loads(40, 0.5F);
  FrameEncoder encoder(7, 40, kSpace, 99);
  encoder.take(snapshot, {.wanted = Pose{Vec3(0, 0, 0.1)}, .held = true, .load_n = loads});
  const auto bytes = encoder.frameSince(0);
  const Read frame(*bytes);
  EXPECT_EQ(frame.real(16), 0.01F);
  EXPECT_EQ(frame.real(28), static_cast<float>(std::sqrt(0.5)));
  EXPECT_EQ(frame.real(44), 1.0F);
  EXPECT_EQ(frame.real(64), -0.03F);
  EXPECT_EQ(frame.real(76), 0.1F);
  EXPECT_EQ(frame.number, 100U);

  EXPECT_EQ(*bytes, bytesOf("tests/data/frame-v1.bin"))
      << "another format needs another version, in docs/reference/web-messages.md, the page and here";

  snapshot.stones = {{Vec3(0.01, -0.02, 0.03), Quat(0.5, -0.5, 0.5, -0.5)}, {Vec3(0.04, 0, 0.05)}};
  FrameEncoder with_stones(7, 40, kSpace, 99);
  with_stones.take(snapshot, {.wanted = Pose{Vec3(0, 0, 0.1)}, .held = true, .load_n = loads});
  EXPECT_EQ(*with_stones.frameSince(0), bytesOf("tests/data/frame-v1-stones.bin"));

  FrameEncoder with_tools(7, 40, kSpace, 99);
  with_tools.take(withTwoTools(snapshot),
                  {.wanted = Pose{Vec3(0, 0, 0.1)}, .held = true, .load_n = loads, .tools = kBesideTwoTools});
  EXPECT_EQ(*with_tools.frameSince(0), bytesOf("tests/data/frame-v1-tools.bin"));

  SceneSnapshot banded = withTwoTools(snapshot);
  banded.tools[0].force_band = {1.5, 3.25};
  FrameEncoder with_bands(7, 40, kSpace, 99);
  with_bands.take(banded, {.wanted = Pose{Vec3(0, 0, 0.1)}, .held = true, .load_n = loads, .tools = kBesideTwoTools});
  EXPECT_EQ(*with_bands.frameSince(0), bytesOf("tests/data/frame-v1-bands.bin"));
}

}  // namespace
}  // namespace haptolith
