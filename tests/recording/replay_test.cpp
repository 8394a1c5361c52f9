// A recording of a run under a person's device, run again: bit for bit, or with the reason why not.

#include "haptolith/recording/replay.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/core/error.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/recording/recording_writer.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;
namespace fs = std::filesystem;

/// A device in a person's hand, which pushes the shovel into the soil and pulls it out, twice a second. Other
/// parameters go wrong in its n-th read() is a test's choice.
class PersonsDevice final : public HapticDevice {
 public:
  using Accident = std::function<void(int read, DeviceInput& input)>;

  explicit PersonsDevice(Accident accident, bool simulated) : accident_(std::move(accident)), simulated_(simulated) {}

  [[nodiscard]] bool simulated() const noexcept override { return simulated_; }

  [[nodiscard]] std::string_view name() const noexcept override { return "a person's"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override {
    DeviceLimits limits;
    limits.max_force_n = 2;
    limits.max_force_rate_n_s = 300;
    limits.workspace_centre_m = Vec3(0.01, 0, 0.005);
    limits.workspace_radius_m = 0.2;
    limits.grips = true;
    return limits;
  }
  [[nodiscard]] DeviceInput read() noexcept override {
    const double phase = 4 * 3.14159265358979 * 1e-3 * reads_;
    DeviceInput input;
    input.pose.position_m = Vec3(0.02 * std::sin(phase / 3), 0.003, -0.045 - 0.055 * std::sin(phase));
    input.twist.linear_m_s = Vec3(0, 0, -0.055 * 12.5 * std::cos(phase));
    input.gripper_open = 0.5;
    accident_(reads_++, input);
    return input;
  }
  void write(const DeviceOutput& output) noexcept override { last_ = output; }
  void releaseForce() noexcept override {}
  void resumeForce() noexcept override {}

  int reads_ = 0;
  DeviceOutput last_;

 private:
  Accident accident_;
  bool simulated_;
};

SceneFile personsScene() {
  SceneFile scene_file;
  scene_file.bed.soil = findPreset("P3").soil;
  scene_file.device.kind = DeviceKind::kNetwork;  // any but the virtual hand
  scene_file.handling.safety.soft_start_s = 0.1;
  scene_file.handling.safety.soft_stop_s = 0.05;
  scene_file.handling.safety.recovery_s = 0.05;
  scene_file.handling.safety.max_missed_deadlines = 5;
  scene_file.loop.real_time = false;
  return scene_file;
}

/// As personsScene(), with a bed that is large enough for several threads to share.
SceneFile largeScene() {
  SceneFile scene_file = personsScene();
  scene_file.bed.width_m = scene_file.bed.length_m = 0.4;
  scene_file.bed.particles = 3000;
  scene_file.bed.layers = 4;
  return scene_file;
}

class ReplayTest : public testing::Test {
 protected:
  ReplayTest() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_replay_{}", getpid())) {
    fs::create_directories(folder_);
  }
  ~ReplayTest() override { fs::remove_all(folder_); }

  /// Lets `drive` run a loop of the scene, and keeps what was recorded of it.
  void record(const SceneFile& scene_file, const PersonsDevice::Accident& accident,
              const std::function<void(HapticLoop&)>& drive) {
    Scene scene(scene_file.bed, scene_file.tool);
    PersonsDevice device([&](int read, DeviceInput& input) { accident(read, input); }, simulated_);
    HapticLoop loop(scene, device, scene_file.loop, true, handlingOf(scene_file, scene.bed().surfaceHeight()));
    loop.hashRecords();
    drive(loop);
    loop.takeRecords(ticks_);
    header_.scene_file = sceneFileText(scene_file);
    header_.arithmetic = arithmetic();
    header_.device = device.name();
    header_.device_limits = limitsText(device.limits(), device.simulated());
    header_.hashed_parts = loop.hashedParts();
    last_felt_ = device.last_;
  }

  [[nodiscard]] RecordingReader recording() const {
    const fs::path file = folder_ / "run.h5";
    RecordingWriter writer(file, header_, {.overwrite = true});
    for (const RecordingEvent& event : events_) {
      writer.add(event);
    }
    writer.add(ticks_);
    for (const ParticleFrame& frame : frames_) {
      writer.add(frame);
    }
    writer.finish();
    return RecordingReader(file);
  }

  [[nodiscard]] ReplayResult replayed(std::optional<int> threads = {}) const {
    const RecordingReader reader = recording();
    return Replay(reader, threads).run([](const TickRecord&, const TickRecord&) { return true; });
  }

  void expectBitForBit(const ReplayResult& result) const {
    EXPECT_EQ(result.ticks, ticks_.size());
    EXPECT_EQ(result.hashes, ticks_.size());
    EXPECT_THAT(result.ended_early, IsEmpty());
    EXPECT_FALSE(result.difference) << result.difference->what << " in tick " << result.difference->tick;
  }

  [[nodiscard]] std::size_t ticksWith(TickFlag flag) const {
    return static_cast<std::size_t>(
        std::count_if(ticks_.begin(), ticks_.end(), [flag](const TickRecord& t) { return (t.flags & flag) != 0; }));
  }
  [[nodiscard]] std::size_t ticksWith(SafetyTrip trip) const {
    return static_cast<std::size_t>(std::count_if(ticks_.begin(), ticks_.end(), [trip](const TickRecord& t) {
      return t.trip == static_cast<std::uint8_t>(trip);
    }));
  }
  [[nodiscard]] double largestFelt() const {
    double largest_n = 0;
    for (const TickRecord& tick : ticks_) {
      largest_n = std::max(largest_n, tick.sent.wrench.force_n.norm());
    }
    return largest_n;
  }

  fs::path folder_;
  RecordingHeader header_;
  bool simulated_ = false;  ///< whether no person is at the device
  std::vector<TickRecord> ticks_;
  std::vector<RecordingEvent> events_;
  std::vector<ParticleFrame> frames_;
  DeviceOutput last_felt_;
};

/// A device without accidents.
void nothingHappens(int, DeviceInput&) {}

void tickTimes(HapticLoop& loop, int count) {
  for (int i = 0; i < count; ++i) {
    ASSERT_EQ(loop.tick(), LoopEnd::kRunning);
  }
}

TEST_F(ReplayTest, EveryTripOfAPersonsHandComesOutBitForBitWhateverTheThreads) {
  const auto accident = [](int read, DeviceInput& input) {
    if (read >= 200 && read < 220) {
      input.state = DeviceState::kStale;
    } else if (read >= 330 && read < 340) {
      input.pose.position_m.x() = 0.5;  // beyond the workspace
    } else if (read >= 460 && read < 463) {
      input.pose.position_m.y() = std::nan("");
    }
  };
  record(largeScene(), accident, [](HapticLoop& loop) {
    tickTimes(loop, 600);
    loop.overrideHealth({.late = false, .heartbeat_lost = true});
    tickTimes(loop, 150);
    ASSERT_TRUE(loop.ask(request::Pause{}));
    tickTimes(loop, 40);  // the hand moves on
    ASSERT_TRUE(loop.ask(request::Advance{3}));
    tickTimes(loop, 10);
    ASSERT_TRUE(loop.ask(request::Resume{}));
    tickTimes(loop, 150);
    loop.softStop();
    tickTimes(loop, 60);
  });
  ASSERT_EQ(ticks_.size(), 963U);
  EXPECT_GE(ticksWith(kTickSoftStart), 300U);
  EXPECT_GE(ticksWith(SafetyTrip::kStale), 20U);
  EXPECT_GE(ticksWith(SafetyTrip::kWorkspace), 10U);
  EXPECT_GE(ticksWith(SafetyTrip::kDeviceNotFinite), 3U);
  EXPECT_GE(ticksWith(SafetyTrip::kHeartbeat), 1U);
  EXPECT_EQ(ticksWith(kTickHeartbeatLost), 1U);
  EXPECT_EQ(ticksWith(kTickResumed), 2U);
  EXPECT_EQ(ticksWith(kTickSoftStop), 60U);
  EXPECT_GT(largestFelt(), 0.5);
  EXPECT_GT(header_.hashed_parts, 1U);
  expectBitForBit(replayed(1));
  expectBitForBit(replayed(2));
}

TEST_F(ReplayTest, ARunByTheClockComesOutBitForBitHoweverLateItWas) {
  using std::chrono::milliseconds;
  SceneFile scene_file = personsScene();
  scene_file.loop.real_time = true;
  scene_file.loop.duration_s = 0.8;
  HapticLoop* running = nullptr;
  const auto accident = [&running](int read, DeviceInput&) {
    if (read >= 200 && read < 210) {
      std::this_thread::sleep_for(milliseconds(2));  // misses its deadline
    } else if (read == 450) {
      std::this_thread::sleep_for(milliseconds(100));  // longer than the watchdog waits
    } else if (read == 650) {
      running->ask(request::Pause{});
    } else if (read == 700) {
      running->ask(request::Resume{});
    }
  };
  record(scene_file, accident, [&running](HapticLoop& loop) {
    running = &loop;
    const std::atomic<bool> stop{false};
    EXPECT_EQ(loop.run(stop), LoopEnd::kDuration);
  });
  EXPECT_GE(ticksWith(kTickLate), 11U);
  EXPECT_GE(ticksWith(kTickHeartbeatLost), 1U);
  EXPECT_EQ(ticksWith(kTickResumed), 1U);
  EXPECT_EQ(last_felt_.wrench.force_n, Vec3::Zero());
  expectBitForBit(replayed());
}

TEST_F(ReplayTest, ADeviceThatShowsNoForceComesOutBitForBitThroughItsVirtualCoupling) {
  SceneFile scene_file = personsScene();
  scene_file.handling.coupling.kind = CouplingKind::kVirtual;
  scene_file.handling.mapping.scale = 1.3;
  scene_file.handling.mapping.turn_rad = Vec3(0.1, 0.2, 0.3);
  scene_file.handling.mapping.clutch_button = 0;
  const auto clutch = [](int read, DeviceInput& input) { input.buttons = read >= 200 && read < 300 ? 1 : 0; };
  record(scene_file, clutch, [](HapticLoop& loop) { tickTimes(loop, 500); });
  EXPECT_GT(largestFelt(), 0.1);
  expectBitForBit(replayed());
}

TEST_F(ReplayTest, OneBitOfWhatTheDeviceToldIsFoundInItsTick) {
  record(personsScene(), nothingHappens, [](HapticLoop& loop) { tickTimes(loop, 700); });
  constexpr std::size_t kDeep = 620;  // in the second push
  ASSERT_GT(ticks_[kDeep].soil.force_n.norm(), 0.1) << "the tool is in the soil";
  double& z_m = ticks_[kDeep].device.pose.position_m.z();
  z_m = std::nextafter(z_m, 1.0);
  const ReplayResult result = replayed();
  ASSERT_TRUE(result.difference);
  EXPECT_EQ(result.difference->tick, kDeep);
  EXPECT_EQ(result.difference->time_s, ticks_[kDeep].time_s);
  EXPECT_EQ(result.ticks, kDeep + 1);
}

TEST_F(ReplayTest, AHashOrAForceThatWasAnotherIsFoundByName) {
  record(personsScene(), nothingHappens, [](HapticLoop& loop) { tickTimes(loop, 100); });
  const std::vector<TickRecord> whole = ticks_;
  const auto findsIn50 = [this](const char* what) {
    const ReplayResult result = replayed();
    ASSERT_TRUE(result.difference);
    EXPECT_EQ(result.difference->tick, 50U);
    EXPECT_EQ(result.difference->what, what);
  };
  ticks_[50].state_hash ^= 1;
  findsIn50("state_hash");
  ticks_ = whole;
  ticks_[50].rendered.wrench.torque_nm.y() += 1e-12;
  findsIn50("rendered force");
  ticks_ = whole;
  ticks_[50].sent.gripper_force_n = -1e-300;
  findsIn50("device wrench");
  ticks_ = whole;
  ticks_[50].scene_T_tool.position_m.x() += 1e-15;
  findsIn50("tool pose");
  ticks_ = whole;
  ticks_[50].soil.force_n.x() = 7;
  findsIn50("soil wrench");
  ticks_ = whole;
  ticks_[50].soil.torque_nm.z() = std::numeric_limits<double>::quiet_NaN();
  findsIn50("soil wrench");
  ticks_ = whole;
  ticks_[50].quick_injected_j += 1e-12;
  findsIn50("injected energy");
  ticks_ = whole;
  ticks_[50].trip = 3;
  findsIn50("trip");
  ticks_ = whole;
  ticks_[50].flags ^= kTickForceSaturated;
  findsIn50("flags");
  ticks_ = whole;
  ticks_[50].flags ^= kTickLate;  // depends on the clock
  EXPECT_FALSE(replayed().difference);
}

// A small bed, and a large one whose snapshots take 16 ticks each; with a pause, and a last snapshot at the end.
TEST_F(ReplayTest, FramesAreComparedAndADifferentParticleIsNamed) {
  for (const int particles : {1500, 6000}) {
    SceneFile scene_file = largeScene();
    scene_file.bed.width_m = scene_file.bed.length_m = particles > 4096 ? 0.5 : 0.25;
    scene_file.bed.particles = particles;
    ticks_.clear();
    frames_.clear();
    record(scene_file, nothingHappens, [this](HapticLoop& loop) {
      const auto keep = [&] {
        if (loop.snapshots().update()) {
          frames_.push_back(particleFrame(loop.snapshots().latest()));
        }
      };
      for (int i = 0; i < 420; ++i) {
        if (i == 203) {
          loop.ask(request::Pause{});
        } else if (i == 226) {
          loop.ask(request::Resume{});
        }
        ASSERT_EQ(loop.tick(), LoopEnd::kRunning);
        keep();
      }
      loop.publishEnd(LoopEnd::kStopped);
      keep();
    });
    ASSERT_GE(frames_.size(), 25U);
    const ReplayResult same = replayed();
    EXPECT_FALSE(same.difference) << same.difference->what << " in tick " << same.difference->tick;
    EXPECT_GE(same.frames, frames_.size() - 4) << "those near the pause may be left out";

    const std::vector<ParticleFrame> whole = frames_;
    ParticleFrame& frame = frames_[20];
    float& x_m = frame.position_m[777][0];
    x_m = std::nextafter(x_m, 1.0F);
    const ReplayResult one = replayed();
    ASSERT_TRUE(one.difference);
    EXPECT_EQ(one.difference->what, "particles");
    EXPECT_EQ(one.difference->tick + 1, frame.tick);
    ASSERT_TRUE(one.difference->frame);
    EXPECT_EQ(one.difference->frame->particle, 777U);
    EXPECT_EQ(one.difference->frame->different, 1U);
    EXPECT_GT(one.difference->frame->distance_m, 0);
    EXPECT_LT(one.difference->frame->distance_m, 1e-7);
    frames_ = whole;
  }
}

TEST_F(ReplayTest, AfterAnotherTickTheNextFrameTellsWhichParticlesDiffer) {
  const auto drive = [this](HapticLoop& loop) {
    for (int i = 0; i < 700; ++i) {
      ASSERT_EQ(loop.tick(), LoopEnd::kRunning);
      if (loop.snapshots().update() && loop.snapshots().latest().ticks % 64 == 1) {
        frames_.push_back(particleFrame(loop.snapshots().latest()));
      }
    }
  };
  record(personsScene(), nothingHappens, drive);
  const std::vector<TickRecord> whole = ticks_;
  double& z_m = ticks_[620].device.pose.position_m.z();
  z_m += 1e-6;
  const ReplayResult moved = replayed();
  ASSERT_TRUE(moved.difference);
  EXPECT_EQ(moved.difference->tick, 620U);
  ASSERT_TRUE(moved.difference->frame);
  EXPECT_EQ(moved.difference->frame->tick, 641U);
  EXPECT_GT(moved.difference->frame->different, 0U);
  EXPECT_LT(moved.difference->frame->distance_m, 1e-3);

  ticks_ = whole;
  ticks_[620].soil.force_n.x() += 1e-12;  // the record is wrong, not the run
  const ReplayResult written = replayed();
  ASSERT_TRUE(written.difference);
  EXPECT_EQ(written.difference->what, "soil wrench");
  ASSERT_TRUE(written.difference->frame);
  EXPECT_EQ(written.difference->frame->different, 0U);

  const RecordingReader reader = recording();
  const ReplayResult before = Replay(reader, {}).run([](const TickRecord&, const TickRecord&) { return true; }, 0.62);
  EXPECT_FALSE(before.difference);
  EXPECT_FALSE(before.gap);
  EXPECT_EQ(before.ticks, 620U);
}

TEST_F(ReplayTest, ATickThatIsMissingIsFound) {
  record(personsScene(), nothingHappens, [](HapticLoop& loop) { tickTimes(loop, 700); });
  ticks_.erase(ticks_.begin() + 620);
  const ReplayResult result = replayed();
  ASSERT_TRUE(result.gap);
  EXPECT_EQ(result.gap->ticks, 1U);
  EXPECT_EQ(result.gap->time_s, 0.62);
  EXPECT_EQ(result.ticks, 620U) << "what came before is compared";
  EXPECT_FALSE(result.difference);
}

TEST_F(ReplayTest, AFirstOrLastTickThatIsMissingIsFound) {
  record(personsScene(), nothingHappens, [](HapticLoop& loop) { tickTimes(loop, 50); });
  EXPECT_FALSE(replayed().gap);
  const std::vector<TickRecord> whole = ticks_;
  ticks_.erase(ticks_.begin(), ticks_.begin() + 3);
  ASSERT_TRUE(replayed().gap);
  EXPECT_EQ(replayed().gap->ticks, 3U);
  ticks_ = {whole.begin(), whole.end() - 7};
  const fs::path file = folder_ / "run.h5";
  {
    RecordingWriter writer(file, header_, {.overwrite = true});
    writer.add(ticks_);
    writer.add(RecordingEvent{.time_s = 0.05, .tick = 43, .kind = "end", .text = "stopped"});
  }
  const RecordingReader reader(file);
  const ReplayResult result = Replay(reader, {}).run([](const TickRecord&, const TickRecord&) { return true; });
  ASSERT_TRUE(result.gap);
  EXPECT_EQ(result.gap->ticks, 7U);
  EXPECT_EQ(result.ticks, 43U);
}

TEST_F(ReplayTest, ARunThatFailsIsReplayedUpToTheTickThatFailed) {
  const auto lost = [](int read, DeviceInput& i) { i.state = read == 80 ? DeviceState::kLost : i.state; };
  // Finite, but no force that a float can hold. At a person's device it would be implausible first.
  const auto leaps = [](int read, DeviceInput& i) {
    i.twist.linear_m_s.z() = read == 80 ? -1e300 : i.twist.linear_m_s.z();
  };
  const std::tuple<bool, PersonsDevice::Accident, LoopEnd> failures[]{{false, lost, LoopEnd::kLost},
                                                                      {true, leaps, LoopEnd::kNotFinite}};
  for (const auto& [simulated, accident, wanted] : failures) {
    ticks_.clear();
    simulated_ = simulated;
    LoopEnd end = LoopEnd::kRunning;
    std::size_t ticks = 0;
    record(personsScene(), accident, [&](HapticLoop& loop) {
      for (; end == LoopEnd::kRunning && ticks < 3000; ++ticks) {
        end = loop.tick();
      }
    });
    ASSERT_EQ(end, wanted);
    ASSERT_EQ(ticks_.size(), ticks);
    EXPECT_EQ(ticksWith(kTickFailed), 1U);
    const ReplayResult result = replayed();
    EXPECT_EQ(result.ticks, ticks);
    EXPECT_FALSE(result.difference);
    EXPECT_EQ(result.end, fmt::format("at {:.3f} s: {}", 1e-3 * static_cast<double>(ticks), text(wanted)));
    ticks_.back().flags &= ~static_cast<std::uint32_t>(kTickFailed);
    ASSERT_TRUE(replayed().difference) << "a run that did not end there";
    EXPECT_EQ(replayed().difference->what, "end");
  }
}

TEST_F(ReplayTest, SoilThatLearnsIsReplayedToTheLastBit) {
  SceneFile scene_file = personsScene();
  scene_file.bed.soil.friction = FrictionModel::kContact;
  scene_file.bed.soil.contact_cohesion_n = 0.01;
  record(scene_file, nothingHappens, [&](HapticLoop& loop) {
    for (int i = 0; i < 300; ++i) {
      if (i % 20 == 10) {
        const SoilAdjustment step{0.5 - 1.0 / 3 * i / 300, 0.01 + 1e-4 * i / 7, 0.36 + 1e-3 * i};
        ASSERT_TRUE(loop.ask(request::Adjust{SoilLaws(step.of(scene_file.bed.soil)), step.tool_friction}));
        events_.push_back({.time_s = 1e-3 * i, .kind = kAdjustmentKind, .text = adjustmentText(step)});
      }
      tickTimes(loop, 1);
    }
  });
  EXPECT_EQ(ticksWith(kTickSoilAdjusted), 15U);
  EXPECT_GT(largestFelt(), 0);
  expectBitForBit(replayed());

  const std::vector<RecordingEvent> all = events_;
  events_.resize(3);
  EXPECT_EQ(replayed().ended_early, "at 0.071 s the soil changed; the change is not recorded");
  EXPECT_EQ(replayed().ticks, 70U);
  events_ = all;
  std::swap(events_[3], events_[9]);
  EXPECT_TRUE(replayed().difference) << "another soil is felt otherwise";
  events_ = all;
  for (const char* nonsense :
       {"", "{}", R"({"contact_friction": "much", "contact_cohesion_n": 0, "tool_friction": 0})"}) {
    events_[2].text = nonsense;
    EXPECT_THROW((void)replayed(), Failure) << nonsense;
  }
  events_[2].text = R"({"contact_friction": -1, "contact_cohesion_n": 0, "tool_friction": 0})";
  EXPECT_THROW((void)replayed(), InvalidParameter);
}

TEST_F(ReplayTest, GrainsThatWereMovedAreMovedAgain) {
  const SceneFile scene_file = personsScene();
  const Bed same(scene_file.bed);
  record(scene_file, nothingHappens, [&](HapticLoop& loop) {
    for (std::size_t i = 0; i < 100; ++i) {
      if (i % 25 == 10) {
        const Float4& at = same.state().position[i];
        const GrainMove move{i, Vec3(at.x, at.y, at.z), {-0.05 + 4e-3 / 3 * static_cast<double>(i), 0.05, 0.1}};
        ASSERT_TRUE(loop.ask(request::MoveGrain{move}));
        events_.push_back(
            {.time_s = 1e-3 * static_cast<double>(i), .kind = kGrainMoveKind, .text = grainMoveText(move)});
        EXPECT_EQ(grainMoveOf(events_.back()), move);
      }
      tickTimes(loop, 1);
    }
  });
  EXPECT_EQ(ticksWith(kTickParticleMoved), 4U);
  expectBitForBit(replayed());

  const std::vector<RecordingEvent> all = events_;
  events_.resize(2);
  EXPECT_EQ(replayed().ended_early, "at 0.061 s a particle was moved; its index is not recorded");
  events_ = all;
  std::swap(events_[0], events_[1]);
  EXPECT_TRUE(replayed().difference) << "another grain";
  for (const char* nonsense : {"", "{}", R"({"grain": "one", "from_m": [0, 0, 0], "to_m": [0, 0, 0]})",
                               R"({"grain": 1, "from_m": [0, 0], "to_m": [0, 0, 0]})",
                               R"({"grain": -1, "from_m": [0, 0, 0], "to_m": [0, 0, 0]})",
                               R"({"grain": 0.5, "from_m": [0, 0, 0], "to_m": [0, 0, 0]})",
                               R"({"grain": 1e300, "from_m": [0, 0, 0], "to_m": [0, 0, 0]})"}) {
    events_ = all;
    events_[1].text = nonsense;
    EXPECT_THROW((void)replayed(), Failure) << nonsense;
  }
  events_ = all;
  events_[1].text = R"({"grain": 99999999, "from_m": [0, 0, 0], "to_m": [1e300, 0, 0]})";
  EXPECT_TRUE(replayed().difference) << "which it does not do";
}

TEST_F(ReplayTest, AChangedSceneEndsTheComparisonAndSaysWhy) {
  record(personsScene(), nothingHappens, [](HapticLoop& loop) {
    tickTimes(loop, 120);
    ASSERT_TRUE(loop.ask(request::Gravity{Vec3(0, 0, -9.81)}));
    tickTimes(loop, 50);
  });
  const ReplayResult result = replayed();
  EXPECT_EQ(result.ticks, 120U);
  EXPECT_FALSE(result.difference);
  EXPECT_EQ(result.ended_early, "at 0.121 s a client changed the scene");
}

TEST_F(ReplayTest, WhoeverLooksOnMayEndIt) {
  record(personsScene(), nothingHappens, [](HapticLoop& loop) { tickTimes(loop, 30); });
  const RecordingReader reader = recording();
  const ReplayResult result =
      Replay(reader, {}).run([](const TickRecord& was, const TickRecord&) { return was.time_s < 0.0105; });
  EXPECT_EQ(result.ticks, 11U);
  EXPECT_EQ(result.ended_early, "interrupted");
}

TEST_F(ReplayTest, ARecordingOfTheMiddleOfARunIsRefused) {
  record(personsScene(), nothingHappens, [](HapticLoop& loop) { tickTimes(loop, 10); });
  header_.start_tick = 4711;
  EXPECT_THAT([this] { (void)replayed(); },
              ThrowsMessage<Failure>(AllOf(HasSubstr("tick 4711"), HasSubstr("haptolith run --record"))));
}

TEST_F(ReplayTest, ASceneOrDeviceThatCannotBeReadIsRefused) {
  record(personsScene(), nothingHappens, [](HapticLoop& loop) { tickTimes(loop, 10); });
  const RecordingHeader whole = header_;
  header_.scene_file = "[bed]\nparticles = \"many\"\n";
  EXPECT_THAT([this] { (void)replayed(); }, ThrowsMessage<InvalidParameter>(HasSubstr("the recorded scene")));
  header_ = whole;
  header_.device_limits = "{}";
  EXPECT_THAT([this] { (void)replayed(); }, ThrowsMessage<Failure>(HasSubstr("the recorded device")));
}

TEST(DeclaredLimitsText, ComesBackAsItWasAlsoWithoutLimits) {
  DeviceLimits limits;
  limits.max_force_n = 0.1 + 0.2;  // a number that needs 17 digits
  limits.max_torque_nm = 5e-324;
  limits.max_gripper_force_n = 3;
  limits.max_torque_rate_nm_s = 4;
  limits.max_stiffness_nm_rad = 5;
  limits.damping_n_s_m = 1.0 / 3;
  limits.workspace_centre_m = Vec3(-0.1, 1e-17, 7);
  limits.workspace_radius_m = 0.25;
  limits.rate_hz = 60;
  limits.delay_s = 0.016;
  limits.turns = false;
  limits.shows_force = false;
  limits.grips = true;
  for (const bool simulated : {false, true}) {
    const DeclaredLimits read = limitsOf(limitsText(limits, simulated));
    EXPECT_EQ(read.simulated, simulated);
    EXPECT_EQ(read.limits.max_force_n, limits.max_force_n);
    EXPECT_EQ(read.limits.max_torque_nm, limits.max_torque_nm);
    EXPECT_EQ(read.limits.max_gripper_force_n, limits.max_gripper_force_n);
    EXPECT_EQ(read.limits.max_force_rate_n_s, DeviceLimits::kNone);
    EXPECT_EQ(read.limits.max_torque_rate_nm_s, limits.max_torque_rate_nm_s);
    EXPECT_EQ(read.limits.max_gripper_rate_n_s, DeviceLimits::kNone);
    EXPECT_EQ(read.limits.max_stiffness_n_m, DeviceLimits::kNone);
    EXPECT_EQ(read.limits.max_stiffness_nm_rad, limits.max_stiffness_nm_rad);
    EXPECT_EQ(read.limits.damping_n_s_m, limits.damping_n_s_m);
    EXPECT_EQ(read.limits.workspace_centre_m, limits.workspace_centre_m);
    EXPECT_EQ(read.limits.workspace_radius_m, limits.workspace_radius_m);
    EXPECT_EQ(read.limits.rate_hz, limits.rate_hz);
    EXPECT_EQ(read.limits.delay_s, limits.delay_s);
    EXPECT_EQ(read.limits.turns, limits.turns);
    EXPECT_EQ(read.limits.shows_force, limits.shows_force);
    EXPECT_EQ(read.limits.grips, limits.grips);
  }
  EXPECT_EQ(limitsOf(limitsText({}, true)).limits.workspace_radius_m, DeviceLimits::kNone);
}

TEST(DeclaredLimitsText, GarbageIsRefused) {
  const std::string whole = limitsText({}, true);
  std::string wrong_type = whole;
  wrong_type.replace(wrong_type.find("\"rate_hz\":"), 10, "\"rate_hz\":true,\"x\":");
  std::string short_centre = whole;
  short_centre.replace(short_centre.find("[0.0,0.0,0.0]"), 13, "[0.0,0.0]");
  for (const std::string& text :
       {std::string(), std::string("nonsense"), std::string("[]"), std::string("{}"), std::string("{\"simulated\": 1}"),
        whole.substr(0, whole.size() / 2), wrong_type, short_centre}) {
    EXPECT_THAT([&] { (void)limitsOf(text); }, ThrowsMessage<Failure>(HasSubstr("limits of the recorded device")))
        << text;
  }
}

// --- several tools ---

/// Two hands and a driven wheel; the second hand trips twice.
class ReplayOfTools : public ReplayTest {
 protected:
  static SceneFile scene() {
    return sceneFileFromText(
        "[bed]\nwidth_mm = 300\nparticles = 600\n[loop]\nreal_time = false\n"
        "[safety]\nsoft_start_s = 0.1\nrecovery_s = 0.05\n[device]\nkind = 'network'\n"
        "[[tools]]\nname = 'left'\n[tools.mapping]\noffset_mm = [-80, 0, 85]\n"
        "[[tools]]\nname = 'right'\n[tools.device]\naddress = '127.0.0.1:9051'\n[tools.mapping]\noffset_mm = [80, 0, "
        "85]\n"
        "[[tools]]\nname = 'wheel'\nshape = 'cylinder'\njoint_drive = 'torque'\njoint_axis = [0, 0, 1]\n"
        "joint_torque_nm = 0.01\njoint_inertia_kg_m2 = 0.01\n"
        "[tools.device]\nkind = 'virtual-hand'\n[tools.hand]\nmotion = 'press'\nturn_deg = [90, 0, 0]\n",
        "three.toml");
  }

  void recordTools(int ticks) {
    SceneFile scene_file = scene();
    Scene soil(scene_file.bed, toolSet(scene_file));
    const double surface_m = soil.bed().surfaceHeight();
    const auto trips = [](int read, DeviceInput& input) {
      if (read >= 200 && read < 220) {
        input.state = DeviceState::kStale;
      } else if (read == 400) {
        input.pose.position_m.y() = std::nan("");
      }
    };
    PersonsDevice left(nothingHappens, false), right(trips, false);
    std::vector<HapticDevice*> devices{&left, &right};
    scene_file.more_tools.back().hand.surface_m = surface_m;
    VirtualHand script(scene_file.more_tools.back().hand, kTick_s);
    devices.push_back(&script);
    std::vector<ToolHandling> hands;
    std::vector<RecordedTool> tools;
    for (std::size_t i = 0; i < devices.size(); ++i) {
      exchangeFirst(scene_file, i);
      hands.push_back({devices[i], handlingOf(scene_file, surface_m)});
      tools.push_back({scene_file.tool_name, std::string(devices[i]->name()),
                       limitsText(devices[i]->limits(), devices[i]->simulated()), scene_file.tool.joint.any()});
      exchangeFirst(scene_file, i);
    }
    HapticLoop loop(soil, hands, scene_file.loop, true);
    loop.hashRecords();
    tickTimes(loop, ticks);
    loop.takeRecords(ticks_);
    header_.scene_file = sceneFileText(scene_file);
    header_.arithmetic = arithmetic();
    header_.device = tools.front().device;
    header_.device_limits = tools.front().device_limits;
    header_.hashed_parts = loop.hashedParts();
    header_.tools = toolsText(tools);
  }

  static constexpr double kTick_s = 1e-3;
};

TEST_F(ReplayOfTools, ComesOutBitForBitAndHasEveryColumn) {
  recordTools(600);
  const RecordingReader reader = recording();
  ASSERT_EQ(reader.tools().size(), 3U);
  EXPECT_EQ(reader.tools()[1].name, "right");
  EXPECT_TRUE(reader.tools()[2].has_joint);
  ASSERT_EQ(reader.ticks(), 600U);
  for (std::size_t tool = 0; tool < 3; ++tool) {
    const std::vector<TickRecord> rows = reader.readTicks(0, 600, tool);
    ASSERT_EQ(rows.size(), 600U);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const TickRecord& was = ticks_[3 * row + tool];
      ASSERT_EQ(rows[row].soil.force_n, was.soil.force_n);
      ASSERT_EQ(rows[row].joint.angle_rad, was.joint.angle_rad);
      ASSERT_EQ(rows[row].joint.soil_torque_nm, was.joint.soil_torque_nm);
      ASSERT_EQ(rows[row].trip, was.trip);
      ASSERT_EQ(rows[row].tool, tool);
    }
  }
  EXPECT_NE(ticks_.back().joint.angle_rad, 0);
  const auto trips_of = [&](std::size_t tool) {
    return std::ranges::count_if(ticks_, [tool](const TickRecord& t) { return t.tool == tool && t.trip != 0; });
  };
  EXPECT_EQ(trips_of(0), 0);
  EXPECT_GT(trips_of(1), 50);
  const ReplayResult result = replayed(1);
  EXPECT_EQ(result.ticks, 600U);
  EXPECT_THAT(result.ended_early, IsEmpty());
  EXPECT_FALSE(result.difference) << result.difference->what << " in tick " << result.difference->tick;
}

TEST_F(ReplayOfTools, ADifferenceNamesItsTool) {
  recordTools(100);
  ticks_[3 * 50 + 1].soil.force_n.x() += 1e-15;
  ASSERT_TRUE(replayed().difference);
  EXPECT_EQ(replayed().difference->what, "right: soil wrench");
  EXPECT_EQ(replayed().difference->tick, 50U);
  ticks_[3 * 40 + 2].joint.angle_rad += 1e-12;
  EXPECT_EQ(replayed().difference->what, "wheel: joint");
}

TEST_F(ReplayOfTools, RefusesAHeaderWithOtherTools) {
  recordTools(5);
  header_.tools = toolsText({{"left", "a", header_.device_limits}, {"right", "b", header_.device_limits}});
  EXPECT_THAT([&] { (void)replayed(); }, ThrowsMessage<Failure>(HasSubstr("it has 2 tools of 3")));
  header_.tools = R"([{"name": "../etc"}])";
  EXPECT_THAT([&] { (void)recording(); }, ThrowsMessage<Failure>(HasSubstr("no list of tools")));
}

}  // namespace
}  // namespace haptolith
