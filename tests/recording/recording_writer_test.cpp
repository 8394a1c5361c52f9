#include "haptolith/recording/recording_writer.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/child_process.h"
#include "haptolith/recording/recording_file.h"
#include "haptolith/recording/recording_reader.h"

#include "made_up.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Property;
using testing::ThrowsMessage;
namespace fs = std::filesystem;

class RecordingWriterTest : public testing::Test {
 protected:
  RecordingWriterTest() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_recording_{}", getpid())) {
    fs::create_directories(folder_);
  }
  ~RecordingWriterTest() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path file(const std::string& name) const { return folder_ / name; }

  fs::path folder_;
};

std::vector<TickRecord> madeUpTicks(std::uint64_t first, std::uint64_t count) {
  std::vector<TickRecord> ticks;
  for (std::uint64_t n = first; n < first + count; ++n) {
    ticks.push_back(madeUpTick(n));
  }
  return ticks;
}

void expectMadeUp(const std::vector<TickRecord>& ticks, std::uint64_t first) {
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ASSERT_EQ(bitsOf(ticks[i]), bitsOf(madeUpTick(first + i))) << "tick " << first + i;
  }
}

void expectSameHeader(const RecordingHeader& got, const RecordingHeader& wanted) {
  EXPECT_EQ(got.scene_file, wanted.scene_file);
  EXPECT_EQ(got.title, wanted.title);
  EXPECT_EQ(got.program_version, wanted.program_version);
  EXPECT_EQ(got.instruction_set, wanted.instruction_set);
  EXPECT_EQ(got.arithmetic, wanted.arithmetic);
  EXPECT_EQ(got.device, wanted.device);
  EXPECT_EQ(got.device_limits, wanted.device_limits);
  EXPECT_EQ(got.host, wanted.host);
  EXPECT_EQ(got.started_utc, wanted.started_utc);
  EXPECT_EQ(got.seed, wanted.seed);
  EXPECT_EQ(got.threads, wanted.threads);
  EXPECT_EQ(got.hashed_parts, wanted.hashed_parts);
  EXPECT_EQ(got.start_tick, wanted.start_tick);
  EXPECT_EQ(got.tick_s, wanted.tick_s);
}

TEST_F(RecordingWriterTest, TicksThatNeverCameAreNotedWhereTheyAreMissingAndCounted) {
  RecordingHeader header = madeUpHeader();
  header.start_tick = 0;
  RecordingWriter writer(file("gap.h5"), header);
  writer.add(madeUpTicks(1, 100));
  writer.add(madeUpTicks(151, 50));
  writer.finish(60);
  EXPECT_EQ(writer.problem(), "");
  EXPECT_EQ(writer.written().missing, 60U);
  const RecordingReader reader(file("gap.h5"));
  EXPECT_TRUE(reader.finished());
  EXPECT_EQ(reader.ticks(), 150U);
  EXPECT_EQ(reader.missingTicks(), 60U);
  const std::vector<RecordingEvent> events = reader.readEvents(0, 9);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].kind, "missing");
  EXPECT_EQ(events[0].tick, 100U);
  EXPECT_EQ(events[0].time_s, madeUpTick(151).time_s);
  EXPECT_THAT(events[0].text, HasSubstr("50 ticks"));
  EXPECT_THAT(events[1].text, HasSubstr("10 ticks"));
}

TEST_F(RecordingWriterTest, AWholeRecordingAndAPartOfARunLackNothing) {
  RecordingHeader header = madeUpHeader();
  header.start_tick = 40;
  {
    RecordingWriter writer(file("part.h5"), header);
    writer.add(madeUpTicks(57, 100));  // the snapshot that it began with was older
  }
  EXPECT_EQ(RecordingReader(file("part.h5")).missingTicks(), 0U);
  EXPECT_EQ(RecordingReader(file("part.h5")).events(), 0U);
}

TEST_F(RecordingWriterTest, WhatARobotTellsComesBackBitForBit) {
  RobotRow row;
  row.heard_s = 0.125;
  row.command = 41;
  row.commands = 20;
  row.scene_T_tool = {{0.1, -0.0, std::numeric_limits<double>::denorm_min()}, {0.5, -0.5, 0.5, -0.5}};
  row.met = {{1, 2, 3}, {4, 5, std::numeric_limits<double>::infinity()}};
  row.state = 3;
  row.reason = 7;
  SiteRow site;
  site.heard_s = 0.25;
  site.command = 61;
  site.corner_m = {-0.1, 0.2};
  site.cell_m = 0.01;
  site.map = {20, 3};
  site.first = {16, 1};
  site.count = {4, 2};
  site.height_m[7] = 0.0625F;
  {
    RecordingWriter writer(file("robot.h5"), madeUpHeader(), {.robot = true});
    for (int i = 0; i < 200; ++i) {
      writer.add(row);
      writer.add(site);
      ++row.command;
    }
  }
  const RecordingReader reader(file("robot.h5"));
  ASSERT_EQ(reader.reports(), 200U);
  ASSERT_EQ(reader.siteRows(), 200U);
  row.command = 41 + 199;
  const RobotRow back = reader.readReports(199, 5).at(0);
  std::string wanted, got;
  appendCsv(wanted, row);
  appendCsv(got, back);
  EXPECT_EQ(got, wanted);
  EXPECT_THAT(got, HasSubstr("0.125,240,20,0.1,-0,5e-324,0.5,-0.5,0.5,-0.5,1,2,3,4,5,inf,3,7"));
  EXPECT_EQ(csvHeader(robotColumns()),
            "heard_s,command,commands,tool_x_m,tool_y_m,tool_z_m,tool_qw,tool_qx,tool_qy,tool_qz,met_fx_n,met_fy_n,"
            "met_fz_n,met_tx_nm,met_ty_nm,met_tz_nm,state,reason\n");
  const SiteRow seen = reader.readSite(3, 1).at(0);
  EXPECT_EQ(seen.corner_m, site.corner_m);
  EXPECT_EQ(seen.map, site.map);
  EXPECT_EQ(seen.first, site.first);
  EXPECT_EQ(seen.count, site.count);
  EXPECT_EQ(seen.height_m, site.height_m);
}

TEST_F(RecordingWriterTest, WithoutARobotThereIsNoPlaceForOne) {
  {
    RecordingWriter writer(file("alone.h5"), madeUpHeader());
    writer.add(RobotRow());
    writer.add(SiteRow());
    writer.add(madeUpTicks(0, 3));
  }
  const RecordingReader reader(file("alone.h5"));
  EXPECT_EQ(reader.ticks(), 3U);
  EXPECT_EQ(reader.reports(), 0U);
  EXPECT_EQ(reader.siteRows(), 0U);
  EXPECT_TRUE(reader.readReports(0, 10).empty());
  EXPECT_TRUE(reader.readSite(0, 10).empty());
}

// As many chunks as half an hour has at 1 kHz. With HDF5's own caches 0.9 MiB more are in use at its end.
TEST_F(RecordingWriterTest, AFileThatGrowsTakesNoMoreMemory) {
  constexpr int kChunks = 12'000, kChunksAtFirst = 800, kTicksPerChunk = 16;
  constexpr double kMostGrowth_kib = 256;
  const auto heap_kib = [] { return static_cast<double>(mallinfo2().uordblks) / 1024; };
  if (heap_kib() == 0) {
    GTEST_SKIP() << "another heap than the system's";
  }
  RecordingHeader header = madeUpHeader();
  header.tick_s = 0.01;
  hdf5::RecordingFile recording(file("long.h5"), header, false, false);
  const std::vector<TickRecord> ticks = madeUpTicks(0, kTicksPerChunk);
  const std::vector<ParticleFrame> frames{madeUpFrame(0, 256), madeUpFrame(1, 256)};
  double at_first_kib = 0;
  for (int chunk = 0; chunk < kChunks; ++chunk) {
    recording.take({.ticks = ticks, .frames = frames});
    ASSERT_TRUE(recording.writeWholeChunks());
    at_first_kib = chunk == kChunksAtFirst ? heap_kib() : at_first_kib;
  }
  EXPECT_LT(heap_kib() - at_first_kib, kMostGrowth_kib);
  recording.close();
}

TEST_F(RecordingWriterTest, EveryBitComesBack) {
  constexpr std::uint64_t kTicks = 5000;
  {
    RecordingWriter writer(file("a.h5"), madeUpHeader());
    for (std::uint64_t n = 0; n < kTicks; n += 50) {
      writer.add(madeUpTicks(n, 50));
    }
    writer.finish();
    EXPECT_EQ(writer.problem(), "");
    EXPECT_EQ(writer.written().ticks, kTicks);
    EXPECT_GT(writer.written().bytes, 1000 * kTicks / 10);
  }
  const RecordingReader reader(file("a.h5"));
  EXPECT_TRUE(reader.finished());
  expectSameHeader(reader.header(), madeUpHeader());
  ASSERT_EQ(reader.ticks(), kTicks);
  expectMadeUp(reader.readTicks(0, kTicks), 0);
  const std::vector<TickRecord> across_chunks = reader.readTicks(149, 303);
  ASSERT_EQ(across_chunks.size(), 303U);
  expectMadeUp(across_chunks, 149);
  EXPECT_EQ(reader.readTicks(kTicks - 3, 10).size(), 3U);
  EXPECT_TRUE(reader.readTicks(kTicks + 3, 10).empty());
}

TEST_F(RecordingWriterTest, TheNumberOfParticlesMayChange) {
  const std::vector<std::size_t> particles{256, 256, 0, 20000, 1};
  RecordingWriter writer(file("a.h5"), madeUpHeader());
  for (std::size_t n = 0; n < particles.size(); ++n) {
    writer.add(madeUpFrame(n, particles[n]));
  }
  writer.finish();
  const RecordingReader reader(file("a.h5"));
  const std::vector<FrameRow> rows = reader.readFrameRows(0, 100);
  ASSERT_EQ(rows.size(), particles.size());
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const ParticleFrame wanted = madeUpFrame(n, particles[n]);
    const ParticleFrame frame = reader.readFrame(rows[n]);
    EXPECT_EQ(frame.time_s, wanted.time_s);
    EXPECT_EQ(frame.tick, wanted.tick);
    EXPECT_EQ(frame.position_m, wanted.position_m) << "frame " << n;
  }
}

TEST_F(RecordingWriterTest, EventsAreCutBetweenLetters) {
  RecordingWriter writer(file("a.h5"), madeUpHeader());
  writer.add(RecordingEvent{.time_s = 1.5, .tick = 1500, .kind = "scene", .text = "gravity_m_s2 = 1.62"});
  std::string longest(RecordingEvent::kMostText - 1, 'x');
  writer.add(RecordingEvent{.time_s = 2, .tick = 2000, .kind = std::string(40, 'k'), .text = longest + "ä"});
  writer.finish();
  const std::vector<RecordingEvent> events = RecordingReader(file("a.h5")).readEvents(0, 10);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].time_s, 1.5);
  EXPECT_EQ(events[0].tick, 1500U);
  EXPECT_EQ(events[0].kind, "scene");
  EXPECT_EQ(events[0].text, "gravity_m_s2 = 1.62");
  EXPECT_EQ(events[1].kind, std::string(RecordingEvent::kMostKind, 'k'));
  EXPECT_EQ(events[1].text, longest);
}

TEST_F(RecordingWriterTest, ALongSceneFitsIntoTheHeader) {
  RecordingHeader header = madeUpHeader();
  header.scene_file.assign(300'000, '#');
  header.host.clear();
  RecordingWriter(file("a.h5"), header).finish();
  expectSameHeader(RecordingReader(file("a.h5")).header(), header);
}

TEST_F(RecordingWriterTest, AHeaderThatCannotBeReadBackIsRefused) {
  RecordingHeader header = madeUpHeader();
  header.tick_s = 0;
  EXPECT_THROW(RecordingWriter(file("a.h5"), header), InvalidParameter);
  header = madeUpHeader();
  header.title = std::string("a\0b", 3);
  EXPECT_THROW(RecordingWriter(file("a.h5"), header), InvalidParameter);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(RecordingWriterTest, AnExistingFileIsKeptUnlessToldOtherwise) {
  std::ofstream(file("a.h5")) << "precious";
  EXPECT_THAT([&] { RecordingWriter(file("a.h5"), madeUpHeader()); },
              ThrowsMessage<Failure>(AllOf(HasSubstr("a.h5"), HasSubstr("already exists"))));
  std::string content;
  std::getline(std::ifstream(file("a.h5")), content);
  EXPECT_EQ(content, "precious");
  RecordingWriter(file("a.h5"), madeUpHeader(), {.overwrite = true}).finish();
  EXPECT_EQ(RecordingReader(file("a.h5")).ticks(), 0U);
}

TEST_F(RecordingWriterTest, AFileThatCannotBeMadeIsToldWithTheReason) {
  EXPECT_THAT([&] { RecordingWriter(file("missing") / "a.h5", madeUpHeader()); },
              ThrowsMessage<Failure>(AllOf(HasSubstr("missing/a.h5"), HasSubstr("No such file or directory"))));
  EXPECT_THAT([&] { RecordingWriter("/dev/null", madeUpHeader(), {.overwrite = true}); },
              ThrowsMessage<Failure>(HasSubstr("not a regular file")));
  if (geteuid() != 0) {  // root may write anywhere
    fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_THAT([&] { RecordingWriter(file("a.h5"), madeUpHeader()); },
                ThrowsMessage<Failure>(HasSubstr("Permission denied")));
    fs::permissions(folder_, fs::perms::owner_all);
  }
  EXPECT_THAT([&] { RecordingWriter("/proc/a.h5", madeUpHeader()); }, ThrowsMessage<Failure>(HasSubstr("/proc/a.h5")));
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(RecordingWriterTest, WhatWasAddedIsSoonInTheFileAndCanBeReadMeanwhile) {
  RecordingWriter writer(file("a.h5"), madeUpHeader());
  writer.add(madeUpTicks(0, 10));
  writer.add(madeUpFrame(0, 5));
  for (int tries = 0; tries < 500 && writer.written().frames == 0; ++tries) {
    std::this_thread::sleep_for(10ms);
  }
  const RecordingReader reader(file("a.h5"));
  EXPECT_FALSE(reader.finished());
  EXPECT_EQ(reader.ticks(), 10U);
  EXPECT_EQ(reader.frames(), 1U);
}

TEST_F(RecordingWriterTest, ARemovedFileEndsTheRecording) {
  RecordingWriter writer(file("a.h5"), madeUpHeader());
  fs::remove(file("a.h5"));
  for (int tries = 0; tries < 500 && writer.problem().empty(); ++tries) {
    writer.add(madeUpTicks(0, 10));
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_THAT(writer.problem(), AllOf(HasSubstr("a.h5"), HasSubstr("the file was removed")));
  writer.add(madeUpTicks(0, 10));
  writer.finish();
}

TEST_F(RecordingWriterTest, AFullDiskEndsTheRecordingAndKeepsWhatIsInTheFile) {
  for (const int limit : {100'000, 250'000, 600'000}) {
    const std::string name = fmt::format("{}.h5", limit);
    ASSERT_EQ(std::system(fmt::format("timeout 60 '{}' full '{}' {} > '{}'", RECORDING_HELPER, file(name).string(),
                                      limit, file("out").string())
                              .c_str()),
              0)
        << "hangs or crashes";
    std::string problem;
    std::getline(std::ifstream(file("out")), problem);
    EXPECT_THAT(problem, AllOf(HasSubstr(name), HasSubstr("File too large"), HasSubstr("it contains")));
    const RecordingReader reader(file(name));
    EXPECT_THAT(problem, HasSubstr(fmt::format("it contains {} ticks, {} frames", reader.ticks(), reader.frames())));
    expectMadeUp(reader.readTicks(0, reader.ticks()), 0);
    for (const FrameRow& row : reader.readFrameRows(0, reader.frames())) {
      EXPECT_EQ(reader.readFrame(row).position_m, madeUpFrame(row.tick / 33, row.count).position_m);
    }
  }
  EXPECT_GT(RecordingReader(file("600000.h5")).ticks(), 0U);
}

TEST_F(RecordingWriterTest, ADiskTooFullForAnEmptyRecordingIsToldAtOnce) {
  EXPECT_NE(std::system(fmt::format("timeout 60 '{}' full '{}' 1000 2> '{}'", RECORDING_HELPER, file("a.h5").string(),
                                    file("err").string())
                            .c_str()),
            0);
  std::ifstream errors(file("err"));
  const std::string text{std::istreambuf_iterator<char>(errors), {}};
  EXPECT_THAT(text, AllOf(HasSubstr("a.h5"), HasSubstr("File too large")));
  EXPECT_FALSE(fs::exists(file("a.h5")));
}

/// Kills a program that records, at a random moment, and checks its file. Returns the number of lost ticks.
std::uint64_t ticksLostInKill(const fs::path& path, std::chrono::milliseconds after) {
  const fs::path added_path = path.string() + ".added";
  fs::remove(path);
  fs::remove(added_path);
  {
    const ChildProcess child(
        {.arguments = {RECORDING_HELPER, "record", path.string()}, .package = "", .environment = {}}, {});
    for (int tries = 0; tries < 1000 && !fs::exists(path); ++tries) {
      std::this_thread::sleep_for(1ms);
    }
    std::this_thread::sleep_for(after);
  }
  std::uint64_t added = 0;
  std::ifstream(added_path, std::ios::binary).read(reinterpret_cast<char*>(&added), sizeof(added));
  const RecordingReader reader(path);
  EXPECT_FALSE(reader.finished());
  expectSameHeader(reader.header(), madeUpHeader());
  expectMadeUp(reader.readTicks(0, reader.ticks()), 0);
  for (const FrameRow& row : reader.readFrameRows(0, reader.frames())) {
    const ParticleFrame frame = reader.readFrame(row);
    EXPECT_EQ(frame.position_m, madeUpFrame(row.tick / 33, row.count).position_m) << "frame " << row.tick / 33;
  }
  return added - std::min(added, reader.ticks());
}

void killOften(const fs::path& path, int times, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint64_t> lost;
  for (int n = 0; n < times; ++n) {
    const std::chrono::milliseconds after(n == 0 ? 0 : random() % 900);
    lost.push_back(ticksLostInKill(path, after));
  }
  std::sort(lost.begin(), lost.end());
  // Half a second is promised; a busy machine may keep the writing thread waiting now and then.
  EXPECT_LE(lost[lost.size() / 2], 500U);
  EXPECT_LE(lost.back(), 2000U);
  testing::Test::RecordProperty("most_ticks_lost", static_cast<int>(lost.back()));
  std::printf("ticks lost: median %d, most %d\n", static_cast<int>(lost[lost.size() / 2]),
              static_cast<int>(lost.back()));
}

TEST_F(RecordingWriterTest, AKilledProgramLeavesAFileThatOpens) {
  killOften(file("a.h5"), 10, std::random_device{}());
}

}  // namespace
}  // namespace haptolith
