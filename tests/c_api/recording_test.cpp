#include <gmock/gmock.h>
#include <haptolith/recording.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "../source_dir.h"
#include "device.h"
#include "struct_memory.h"
#include "sweep.h"
#include "use.h"

namespace haptolith::library {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

struct DestroyRecording {
  void operator()(hapto_recorder* recorder) const { hapto_recorder_destroy(recorder); }
  void operator()(hapto_recording* recording) const { hapto_recording_destroy(recording); }
};
using RecorderPtr = std::unique_ptr<hapto_recorder, DestroyRecording>;
using RecordingPtr = std::unique_ptr<hapto_recording, DestroyRecording>;

constexpr std::uint32_t kRecorded = HAPTO_LOOP_TICKED_BY_CALLER | HAPTO_LOOP_KEEPS_TICKS | HAPTO_LOOP_HASHES;

class LibraryRecording : public testing::Test {
 protected:
  LibraryRecording() { fs::create_directories(folder_); }
  ~LibraryRecording() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }

  static LoopPtr loopOf(hapto_scene* scene, const hapto_device* device, std::uint32_t flags = kRecorded) {
    hapto_loop* loop = nullptr;
    expectOk(hapto_loop_create(scene, device, flags, &loop));
    return LoopPtr(loop);
  }
  static RecorderPtr recorderOf(hapto_loop* loop, const std::string& path, double frames_per_s = 10) {
    hapto_recorder* recorder = nullptr;
    expectOk(hapto_recorder_create(loop, path.c_str(), frames_per_s, 0, &recorder));
    return RecorderPtr(recorder);
  }
  static RecordingPtr recordingOf(const std::string& path) {
    hapto_recording* recording = nullptr;
    expectOk(hapto_recording_open(path.c_str(), &recording));
    return RecordingPtr(recording);
  }
  static std::string textOf(const hapto_recording* recording,
                            std::int32_t (*get)(const hapto_recording*, char*, std::uint64_t, std::uint64_t*)) {
    std::uint64_t needed = 0;
    EXPECT_EQ(get(recording, nullptr, 0, &needed), HAPTO_TOO_SMALL);
    std::string text(needed, '\0');
    expectOk(get(recording, text.data(), text.size(), &needed));
    text.pop_back();
    return text;
  }
  static hapto_recording_info infoOf(const hapto_recording* recording) {
    auto info = sized<hapto_recording_info>();
    expectOk(hapto_recording_get_info(recording, &info));
    return info;
  }
  static hapto_replay_report verified(hapto_recording* recording, std::uint32_t threads = 0) {
    auto report = sized<hapto_replay_report>();
    expectOk(hapto_recording_verify(recording, threads, nullptr, nullptr, &report));
    return report;
  }
  static void tick(hapto_loop* loop, int times) {
    for (int i = 0; i < times; ++i) {
      ASSERT_EQ(hapto_loop_tick(loop, 0), HAPTO_OK);
    }
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("haptolith_library_recording_" + std::to_string(getpid()));
};

TEST_F(LibraryRecording, HasWhatTheSoilDoesInTheScenesFrameAndWhatTheDeviceWasSentInItsOwn) {
  for (const int mapping_deg : {0, 90, 180}) {
    SCOPED_TRACE(mapping_deg);
    const std::string turned = "mapping.turn_deg=[0, 0, " + std::to_string(mapping_deg) + "]";
    const ScenePtr scene = sceneOf(kIcra2021, {kZeroInSoil, turned.c_str()});
    SweepingDevice hand{.sweep = {.turn_rad = mapping_deg * M_PI / 180}};
    const hapto_device device = hand.handle();
    const LoopPtr loop = loopOf(scene.get(), &device);
    const std::string path = file("turned" + std::to_string(mapping_deg) + ".h5");
    const RecorderPtr recorder = recorderOf(loop.get(), path);
    tick(loop.get(), 480);
    expectOk(hapto_recorder_finish(recorder.get()));
    const RecordingPtr recording = recordingOf(path);
    std::vector<hapto_tick> ticks(480);
    std::uint64_t count = 0;
    expectOk(hapto_recording_read_ticks(recording.get(), 0, ticks.data(), ticks.size(), &count));
    ASSERT_EQ(count, 480U);
    expectPushedBack(ticks, hand.sweep);
    EXPECT_EQ(ticks.back().felt.force_n[0], hand.last.wrench.force_n[0]);
    EXPECT_EQ(ticks.back().felt.force_n[1], hand.last.wrench.force_n[1]);
  }
}

TEST_F(LibraryRecording, OfAnOwnDeviceIsRunAgainToTheLastBit) {
  for (const char* toml : {kIcra2021, kContact}) {
    const std::string path = file(toml == kIcra2021 ? "icra2021.h5" : "contact.h5");
    const ScenePtr scene = sceneOf(toml, {"mapping.offset_mm=[3, 0, 12]", "mapping.turn_deg=[0, 0, 30]"});
    OwnDevice own;
    own.height_m = -0.01;
    const hapto_device device = own.handle(true);
    const LoopPtr loop = loopOf(scene.get(), &device);
    const RecorderPtr recorder = recorderOf(loop.get(), path);
    for (int i = 0; i < 12; ++i) {
      tick(loop.get(), 50);
      expectOk(hapto_recorder_take(recorder.get()));
    }
    EXPECT_GT(own.strongest_n, 0.05) << "the hand was in the soil";
    expectOk(hapto_recorder_note(recorder.get(), "mark", "here"));
    expectOk(hapto_recorder_finish(recorder.get()));
    auto written = sized<hapto_recorder_info>();
    expectOk(hapto_recorder_get_info(recorder.get(), &written));
    EXPECT_EQ(written.ticks, 600U);
    EXPECT_EQ(written.missing, 0U);
    EXPECT_GE(written.frames, 5U);

    const RecordingPtr recording = recordingOf(path);
    const hapto_recording_info info = infoOf(recording.get());
    EXPECT_EQ(info.finished, 1);
    EXPECT_EQ(info.ticks, 600U);
    EXPECT_EQ(info.start_tick, 0U);
    EXPECT_EQ(info.missing_ticks, 0U);
    for (const std::uint32_t threads : {0U, 2U}) {
      const hapto_replay_report report = verified(recording.get(), threads);
      EXPECT_EQ(report.same, 1) << report.different << " at " << report.different_tick;
      EXPECT_EQ(report.ticks, 600U);
      EXPECT_EQ(report.hashes, 600U);
      EXPECT_STREQ(report.ended_early, "");
    }
    const auto header = nlohmann::json::parse(textOf(recording.get(), hapto_recording_get_header));
    EXPECT_EQ(header["device"], "own");
    EXPECT_EQ(header["program_version"], hapto_version_string());
    const auto events = nlohmann::json::parse(textOf(recording.get(), hapto_recording_get_events));
    ASSERT_EQ(events.size(), 1U);
    EXPECT_EQ(events[0]["kind"], "mark");
    EXPECT_EQ(events[0]["time_s"], 0.6);
  }
}

TEST_F(LibraryRecording, GivesTicksAndPicturesBackAsTheyWere) {
  const ScenePtr scene = sceneOf(kIcra2021);
  OwnDevice own;
  const hapto_device device = own.handle(true);
  const LoopPtr loop = loopOf(scene.get(), &device);
  const RecorderPtr recorder = recorderOf(loop.get(), file("run.h5"), 60);
  tick(loop.get(), 64);  // a picture in the first, and every 16 after
  expectOk(hapto_recorder_take(recorder.get()));
  auto now = sized<hapto_snapshot>();
  expectOk(hapto_loop_snapshot(loop.get(), &now));
  std::vector<float> seen;
  for (std::uint64_t i = 0; i < now.position.count; ++i) {
    const auto* at =
        reinterpret_cast<const float*>(static_cast<const char*>(now.position.data) + i * now.position.stride_bytes);
    seen.insert(seen.end(), at, at + 3);
  }
  expectOk(hapto_recorder_finish(recorder.get()));

  const RecordingPtr recording = recordingOf(file("run.h5"));
  std::vector<hapto_tick> ticks(100);
  std::uint64_t count = 0;
  expectOk(hapto_recording_read_ticks(recording.get(), 60, ticks.data(), 100, &count));
  ASSERT_EQ(count, 4U);
  EXPECT_DOUBLE_EQ(ticks[3].time_s, 0.064);
  EXPECT_NE(ticks[3].state_hash, 0U);
  EXPECT_EQ(ticks[3].size, sizeof(hapto_tick));
  const double t = 1e-3 * 63;
  EXPECT_EQ(ticks[3].device_pose.position_m[0], 0.015 * std::sin(2 * M_PI * 0.5 * t)) << "to the last bit";
  expectOk(hapto_recording_read_ticks(recording.get(), 64, ticks.data(), 100, &count));
  EXPECT_EQ(count, 0U);

  auto frame = sized<hapto_recorded_frame>();
  expectOk(hapto_recording_read_frame(recording.get(), 0, &frame, nullptr, 0));
  ASSERT_EQ(frame.particles, 256U);
  EXPECT_EQ(frame.tick, 49U);
  std::vector<float> positions(3 * frame.particles);
  expectOk(hapto_recording_read_frame(recording.get(), 0, &frame, positions.data(), positions.size()));
  EXPECT_EQ(positions, seen);
  EXPECT_EQ(hapto_recording_read_frame(recording.get(), 0, &frame, positions.data(), 3), HAPTO_TOO_SMALL);
  EXPECT_EQ(hapto_recording_read_frame(recording.get(), 9, &frame, nullptr, 0), HAPTO_INVALID_PARAMETER);
  EXPECT_STREQ(lastError().valid, "less than the number of frames, 1");
}

TEST_F(LibraryRecording, OfALoopWithAThreadLosesNothingAndSaysWhyItEnded) {
  const ScenePtr scene = sceneOf(kIcra2021, {"loop.real_time=false", "loop.duration_s=3"});
  const LoopPtr loop = loopOf(scene.get(), nullptr, HAPTO_LOOP_KEEPS_TICKS | HAPTO_LOOP_HASHES);
  const RecorderPtr recorder = recorderOf(loop.get(), file("run.h5"));
  expectOk(hapto_loop_start(loop.get()));
  auto now = sized<hapto_snapshot>();
  do {
    std::this_thread::sleep_for(5ms);
    expectOk(hapto_recorder_take(recorder.get()));
    expectOk(hapto_loop_snapshot(loop.get(), &now));
  } while (now.running == 1);
  expectOk(hapto_recorder_finish(recorder.get()));
  const RecordingPtr recording = recordingOf(file("run.h5"));
  EXPECT_EQ(infoOf(recording.get()).ticks, 3000U);
  const hapto_replay_report report = verified(recording.get());
  EXPECT_EQ(report.same, 1);
  EXPECT_EQ(report.ticks, 3000U);
  EXPECT_EQ(report.missing, 0U);
  const auto events = nlohmann::json::parse(textOf(recording.get(), hapto_recording_get_events));
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0]["kind"], "end");
  EXPECT_EQ(events[0]["text"], "duration reached");
  EXPECT_EQ(events[0]["time_s"], 3.0);
}

TEST_F(LibraryRecording, OfASceneThatWasStirredBeforeCannotBeRunAgain) {
  const ScenePtr scene = sceneOf(kIcra2021);
  stir(scene.get(), 0, 30);
  OwnDevice own;
  const hapto_device device = own.handle(true);
  const LoopPtr loop = loopOf(scene.get(), &device);
  const RecorderPtr recorder = recorderOf(loop.get(), file("run.h5"));
  tick(loop.get(), 20);
  expectOk(hapto_recorder_finish(recorder.get()));
  const RecordingPtr recording = recordingOf(file("run.h5"));
  EXPECT_EQ(infoOf(recording.get()).start_tick, 30U);
  auto report = sized<hapto_replay_report>();
  EXPECT_EQ(hapto_recording_verify(recording.get(), 0, nullptr, nullptr, &report), HAPTO_FAILURE);
  EXPECT_THAT(lastError().message, HasSubstr("cannot replay"));
}

TEST_F(LibraryRecording, OfAChangedSceneCannotBeRunAgainAndOfACloneCan) {
  const ScenePtr made = sceneOf(kContact);
  auto start_tick = [this, number = 0](hapto_scene* scene) mutable {
    OwnDevice own;
    const hapto_device device = own.handle(true);
    const std::string path = file(std::to_string(++number) + ".h5");
    const LoopPtr loop = loopOf(scene, &device);
    const RecorderPtr recorder = recorderOf(loop.get(), path);
    tick(loop.get(), 5);
    expectOk(hapto_recorder_finish(recorder.get()));
    return infoOf(recordingOf(path).get()).start_tick;
  };
  const auto clone = [&] {
    hapto_scene* scene = nullptr;
    expectOk(hapto_scene_clone(made.get(), &scene));
    return ScenePtr(scene);
  };
  EXPECT_EQ(start_tick(clone().get()), 0U);
  const ScenePtr lighter = clone();
  const double gravity[3] = {0, 0, -1};
  expectOk(hapto_scene_set_gravity(lighter.get(), gravity));
  EXPECT_EQ(start_tick(lighter.get()), 1U);
  const ScenePtr other_tool = clone();
  const char* override = "tool.size_mm=[30, 30, 4]";
  expectOk(hapto_scene_change(other_tool.get(), &override, 1));
  EXPECT_EQ(start_tick(other_tool.get()), 1U);
}

TEST_F(LibraryRecording, BegunLateHasAllThatNobodyHasTakenAndKnowsWhatIsNotInIt) {
  const ScenePtr scene = sceneOf(kIcra2021);
  OwnDevice own;
  const hapto_device device = own.handle(true);
  const LoopPtr loop = loopOf(scene.get(), &device);
  tick(loop.get(), 40);
  {
    const RecorderPtr recorder = recorderOf(loop.get(), file("whole.h5"));
    expectOk(hapto_recorder_finish(recorder.get()));
  }
  const RecordingPtr whole = recordingOf(file("whole.h5"));
  EXPECT_EQ(infoOf(whole.get()).start_tick, 0U);
  EXPECT_EQ(verified(whole.get()).ticks, 40U);
  tick(loop.get(), 10);
  const RecorderPtr recorder = recorderOf(loop.get(), file("part.h5"));
  expectOk(hapto_recorder_finish(recorder.get()));
  const RecordingPtr part = recordingOf(file("part.h5"));
  EXPECT_EQ(infoOf(part.get()).start_tick, 40U);
  EXPECT_EQ(infoOf(part.get()).ticks, 10U);
}

TEST_F(LibraryRecording, CountsTicksThatNobodyTookInTime) {
  const ScenePtr scene = sceneOf(kIcra2021);
  OwnDevice own;
  const hapto_device device = own.handle(true);
  const LoopPtr loop = loopOf(scene.get(), &device);
  const RecorderPtr recorder = recorderOf(loop.get(), file("run.h5"));
  tick(loop.get(), 20'000);
  EXPECT_EQ(hapto_recorder_finish(recorder.get()), HAPTO_FAILURE);
  EXPECT_THAT(lastError().message, HasSubstr("ticks are missing"));
  auto written = sized<hapto_recorder_info>();
  expectOk(hapto_recorder_get_info(recorder.get(), &written));
  EXPECT_EQ(written.ticks + written.missing, 20'000U);
  EXPECT_GT(written.missing, 0U);
}

TEST_F(LibraryRecording, OverwritesNothingUnasked) {
  const ScenePtr scene = sceneOf(kIcra2021);
  OwnDevice own;
  const hapto_device device = own.handle(true);
  const LoopPtr loop = loopOf(scene.get(), &device);
  { std::ofstream(file("mine.h5")) << "mine"; }
  hapto_recorder* recorder = nullptr;
  EXPECT_EQ(hapto_recorder_create(loop.get(), file("mine.h5").c_str(), 0, 0, &recorder), HAPTO_FAILURE);
  std::stringstream text;
  text << std::ifstream(file("mine.h5")).rdbuf();
  EXPECT_EQ(text.str(), "mine");
  expectOk(hapto_recorder_create(loop.get(), file("mine.h5").c_str(), 0, HAPTO_RECORDER_OVERWRITE, &recorder));
  tick(loop.get(), 5);
  expectOk(hapto_recorder_destroy(recorder));
  EXPECT_EQ(infoOf(recordingOf(file("mine.h5")).get()).ticks, 5U);
}

TEST_F(LibraryRecording, RefusesWhatIsNone) {
  { std::ofstream(file("text.h5")) << "no HDF5"; }
  hapto_recording* recording = nullptr;
  for (const char* name : {"text.h5", "missing.h5"}) {
    EXPECT_EQ(hapto_recording_open(file(name).c_str(), &recording), HAPTO_FAILURE);
    EXPECT_THAT(lastError().message, HasSubstr(name));
  }
  const ScenePtr scene = sceneOf(kIcra2021);
  hapto_recorder* recorder = nullptr;
  {
    const LoopPtr without = loopOf(scene.get(), nullptr, HAPTO_LOOP_TICKED_BY_CALLER);
    EXPECT_EQ(hapto_recorder_create(without.get(), file("a.h5").c_str(), 0, 0, &recorder), HAPTO_INVALID_PARAMETER);
    EXPECT_THAT(lastError().message, HasSubstr("HAPTO_LOOP_KEEPS_TICKS"));
  }
  OwnDevice own;
  hapto_device device = own.handle(true);
  device.name = "virtual hand";
  hapto_loop* loop = nullptr;
  EXPECT_EQ(hapto_loop_create(scene.get(), &device, kRecorded, &loop), HAPTO_INVALID_PARAMETER);
  EXPECT_STREQ(lastError().key, "device.name");
  const LoopPtr good = loopOf(scene.get(), nullptr);
  EXPECT_EQ(hapto_recorder_create(good.get(), file("a.h5").c_str(), 61, 0, &recorder), HAPTO_INVALID_PARAMETER);
  EXPECT_STREQ(lastError().key, "frames_per_s");
  EXPECT_EQ(hapto_recorder_create(good.get(), file("a.h5").c_str(), 0, 8, &recorder), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(hapto_recorder_create(good.get(), file("none/a.h5").c_str(), 0, 0, &recorder), HAPTO_FAILURE);
}

TEST_F(LibraryRecording, EndsWithTheLoopThatIsGone) {
  const ScenePtr scene = sceneOf(kIcra2021);
  OwnDevice own;
  const hapto_device device = own.handle(true);
  LoopPtr loop = loopOf(scene.get(), &device);
  RecorderPtr recorder = recorderOf(loop.get(), file("run.h5"));
  tick(loop.get(), 5);
  expectOk(hapto_recorder_take(recorder.get()));
  loop.reset();
  EXPECT_EQ(hapto_recorder_take(recorder.get()), HAPTO_DESTROYED);
  EXPECT_EQ(hapto_recorder_finish(recorder.get()), HAPTO_FAILURE);
  EXPECT_THAT(lastError().message, HasSubstr("the loop was destroyed before"));
  expectOk(hapto_recorder_destroy(recorder.release()));
  EXPECT_EQ(infoOf(recordingOf(file("run.h5")).get()).ticks, 5U);
}

TEST_F(LibraryRecording, VerificationCanBeStopped) {
  const ScenePtr scene = sceneOf(kIcra2021);
  OwnDevice own;
  const hapto_device device = own.handle(true);
  const LoopPtr loop = loopOf(scene.get(), &device);
  const RecorderPtr recorder = recorderOf(loop.get(), file("run.h5"));
  tick(loop.get(), 400);
  expectOk(hapto_recorder_finish(recorder.get()));
  const RecordingPtr recording = recordingOf(file("run.h5"));
  auto report = sized<hapto_replay_report>();
  int told = 0;
  const hapto_progress stops = [](void* user, const char*, double) { return ++*static_cast<int*>(user) < 2 ? 1 : 0; };
  EXPECT_EQ(hapto_recording_verify(recording.get(), 0, stops, &told, &report), HAPTO_STOPPED);
  EXPECT_EQ(told, 2);
}

TEST_F(LibraryRecording, FillsInStructsOfOlderAndNewerVersions) {
  const ScenePtr scene = sceneOf(kIcra2021);
  OwnDevice own;
  const hapto_device device = own.handle(true);
  const LoopPtr loop = loopOf(scene.get(), &device);
  const RecorderPtr recorder = recorderOf(loop.get(), file("run.h5"));
  tick(loop.get(), 120);
  expectOk(hapto_recorder_finish(recorder.get()));
  const RecordingPtr recording = recordingOf(file("run.h5"));
  expectFilledIn<hapto_recorder_info>("hapto_recorder_info", 56, [&](hapto_recorder_info* out) {
    return hapto_recorder_get_info(recorder.get(), out);
  });
  expectFilledIn<hapto_recording_info>("hapto_recording_info", 56, [&](hapto_recording_info* out) {
    return hapto_recording_get_info(recording.get(), out);
  });
  expectFilledIn<hapto_recorded_frame>("hapto_recorded_frame", 32, [&](hapto_recorded_frame* out) {
    return hapto_recording_read_frame(recording.get(), 0, out, nullptr, 0);
  });
  expectFilledIn<hapto_replay_report>("hapto_replay_report", 56, [&](hapto_replay_report* out) {
    return hapto_recording_verify(recording.get(), 0, nullptr, nullptr, out);
  });
}

TEST_F(LibraryRecording, EveryFunctionGivesAStatusForEveryWrongHandle) {
  const ScenePtr scene = sceneOf(kIcra2021);
  OwnDevice own;
  const hapto_device device = own.handle(true);
  const LoopPtr loop = loopOf(scene.get(), &device);
  hapto_recorder* recorder = recorderOf(loop.get(), file("run.h5")).release();
  tick(loop.get(), 5);
  expectOk(hapto_recorder_finish(recorder));
  hapto_recording* recording = recordingOf(file("run.h5")).release();

  auto written = sized<hapto_recorder_info>();
  auto info = sized<hapto_recording_info>();
  auto frame = sized<hapto_recorded_frame>();
  auto report = sized<hapto_replay_report>();
  std::vector<char> text(1 << 16);
  std::uint64_t count = 0;
  hapto_tick one{};
  struct Call {
    const char* function;
    std::function<std::int32_t(hapto_recorder*, hapto_recording*)> with;
  };
  const std::vector<Call> calls{
      {"hapto_recorder_take", [](hapto_recorder* r, hapto_recording*) { return hapto_recorder_take(r); }},
      {"hapto_recorder_note", [](hapto_recorder* r, hapto_recording*) { return hapto_recorder_note(r, "k", "t"); }},
      {"hapto_recorder_finish", [](hapto_recorder* r, hapto_recording*) { return hapto_recorder_finish(r); }},
      {"hapto_recorder_get_info",
       [&](hapto_recorder* r, hapto_recording*) { return hapto_recorder_get_info(r, &written); }},
      {"hapto_recording_get_info",
       [&](hapto_recorder*, hapto_recording* r) { return hapto_recording_get_info(r, &info); }},
      {"hapto_recording_get_header",
       [&](hapto_recorder*, hapto_recording* r) {
         return hapto_recording_get_header(r, text.data(), text.size(), &count);
       }},
      {"hapto_recording_get_events",
       [&](hapto_recorder*, hapto_recording* r) {
         return hapto_recording_get_events(r, text.data(), text.size(), &count);
       }},
      {"hapto_recording_read_ticks",
       [&](hapto_recorder*, hapto_recording* r) { return hapto_recording_read_ticks(r, 0, &one, 1, &count); }},
      {"hapto_recording_read_frame",
       [&](hapto_recorder*, hapto_recording* r) { return hapto_recording_read_frame(r, 0, &frame, nullptr, 0); }},
      {"hapto_recording_verify",
       [&](hapto_recorder*, hapto_recording* r) { return hapto_recording_verify(r, 0, nullptr, nullptr, &report); }},
      {"hapto_recorder_destroy", [](hapto_recorder* r, hapto_recording*) { return hapto_recorder_destroy(r); }},
      {"hapto_recording_destroy", [](hapto_recorder*, hapto_recording* r) { return hapto_recording_destroy(r); }},
  };
  for (const Call& call : calls) {
    EXPECT_EQ(call.with(nullptr, nullptr), HAPTO_NULL) << call.function;
    EXPECT_EQ(call.with(reinterpret_cast<hapto_recorder*>(recording), reinterpret_cast<hapto_recording*>(recorder)),
              HAPTO_DESTROYED)
        << call.function;
  }
  EXPECT_EQ(hapto_recorder_take(recorder), HAPTO_INVALID_PARAMETER) << "it is finished";
  expectOk(hapto_recorder_destroy(recorder));
  expectOk(hapto_recording_destroy(recording));
  for (const Call& call : calls) {
    EXPECT_EQ(call.with(recorder, recording), HAPTO_DESTROYED) << call.function;
  }
  EXPECT_EQ(hapto_recorder_create(nullptr, "x.h5", 0, 0, &recorder), HAPTO_NULL);
  EXPECT_EQ(hapto_recorder_create(loop.get(), nullptr, 0, 0, &recorder), HAPTO_NULL);
  EXPECT_EQ(hapto_recorder_create(loop.get(), "x.h5", 0, 0, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_recording_open(nullptr, &recording), HAPTO_NULL);
  EXPECT_EQ(hapto_recording_open("x.h5", nullptr), HAPTO_NULL);
  const RecordingPtr again = recordingOf(file("run.h5"));
  written.size = info.size = frame.size = report.size = 3;
  EXPECT_EQ(hapto_recording_get_info(again.get(), &info), HAPTO_WRONG_SIZE);
  EXPECT_EQ(hapto_recording_read_frame(again.get(), 0, &frame, nullptr, 0), HAPTO_WRONG_SIZE);
  EXPECT_EQ(hapto_recording_verify(again.get(), 0, nullptr, nullptr, &report), HAPTO_WRONG_SIZE);
  EXPECT_EQ(hapto_recording_read_ticks(again.get(), 0, nullptr, 1, &count), HAPTO_NULL);

  std::set<std::string> called{"hapto_recorder_create", "hapto_recording_open"};
  for (const Call& call : calls) {
    called.insert(call.function);
  }
  std::stringstream header;
  header << std::ifstream(sourceDir() / "include/haptolith/recording.h").rdbuf();
  const std::string declarations = header.str();
  const std::regex declaration(R"(HAPTO_API [\w ]+[ *](hapto_\w+)\()");
  std::set<std::string> declared;
  for (std::sregex_iterator at(declarations.begin(), declarations.end(), declaration), end; at != end; ++at) {
    declared.insert((*at)[1]);
  }
  EXPECT_EQ(called, declared);
}

}  // namespace
}  // namespace haptolith::library
