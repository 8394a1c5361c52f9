// run --record, and replay of what it wrote.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "../source_dir.h"
#include "program.h"

namespace haptolith {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

class ReplayCommand : public testing::Test {
 protected:
  ReplayCommand() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_replay_{}", getpid())) {
    fs::create_directories(folder_);
  }
  ~ReplayCommand() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }

  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  [[nodiscard]] static std::string bytesOf(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  /// The summary of a run that is recorded to run.h5.
  [[nodiscard]] json recorded(const std::string& arguments) const {
    const ProgramResult result = runHaptolith(fmt::format("run --json --record '{}' {}", file("run.h5"), arguments));
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    return json::parse(result.output);
  }

  [[nodiscard]] json verified(const std::string& arguments = "") const {
    const ProgramResult result = runHaptolith(fmt::format("replay --verify --json '{}' {}", file("run.h5"), arguments));
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    return json::parse(result.output);
  }

  /// The rows of run.h5 as CSV: a number for each column's name.
  [[nodiscard]] std::vector<json> ticks() const {
    const ProgramResult result =
        runHaptolith(fmt::format("export '{}' --format csv --overwrite --out '{}'", file("run.h5"), file("run.csv")));
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    std::ifstream in(file("run.csv"));
    const auto cells = [](const std::string& line) {
      std::vector<std::string> all;
      std::istringstream row(line);
      for (std::string cell; std::getline(row, cell, ',');) {
        all.push_back(cell);
      }
      return all;
    };
    std::string line;
    std::getline(in, line);
    const std::vector<std::string> names = cells(line);
    std::vector<json> rows;
    while (std::getline(in, line)) {
      const std::vector<std::string> values = cells(line);
      json row;
      for (std::size_t i = 0; i < names.size(); ++i) {
        row[names[i]] = std::stod(values.at(i));
      }
      rows.push_back(std::move(row));
    }
    return rows;
  }

  fs::path folder_;
};

TEST_F(ReplayCommand, ARecordedRunIsTheSameAgainToTheLastBitWhateverTheThreads) {
  const json run = recorded("icra2021 --motion stir --no-realtime --duration-s 1.5");
  for (const int threads : {1, 2}) {
    const json replay = verified(fmt::format("--threads {}", threads));
    EXPECT_EQ(replay.at("title"), run.at("title"));
    EXPECT_EQ(replay.at("recorded_ticks"), run.at("ticks"));
    EXPECT_EQ(replay.at("replayed_ticks"), run.at("ticks"));
    EXPECT_EQ(replay.at("hashes"), run.at("ticks"));
    EXPECT_TRUE(replay.at("difference").is_null());
    EXPECT_EQ(replay.at("ended_early"), "");
    EXPECT_EQ(replay.at("recorded_simd"), run.at("simd"));
    EXPECT_EQ(replay.at("simd"), run.at("simd"));
    EXPECT_EQ(replay.at("threads"), threads);
  }
  const ProgramResult text = runHaptolith(fmt::format("replay --verify '{}'", file("run.h5")));
  EXPECT_EQ(text.exit_status, 0);
  EXPECT_THAT(text.output, AllOf(HasSubstr("1500 of 1500 ticks"), HasSubstr("1500 hashes"), HasSubstr("verified")));
}

TEST_F(ReplayCommand, AHashThatIsAnotherIsNamedAndFailsToVerify) {
  (void)recorded("icra2021 --motion press --no-realtime --duration-s 0.5");
  const ProgramResult changed =
      runInShell(fmt::format(R"(/usr/bin/python3 -c "import h5py; ticks = h5py.File('{}', 'r+')['ticks']; )"
                             R"(rows = ticks[:]; rows['state_hash'][400] = 1; ticks[:] = rows")",
                             file("run.h5")));
  ASSERT_EQ(changed.exit_status, 0) << changed.errors;
  const ProgramResult failed = runHaptolith(fmt::format("replay --verify --json '{}'", file("run.h5")));
  EXPECT_EQ(failed.exit_status, 1);
  EXPECT_THAT(failed.errors, HasSubstr("differs"));
  const json difference = json::parse(failed.output).at("difference");
  EXPECT_EQ(difference.at("tick"), 400);
  EXPECT_EQ(difference.at("what"), "state_hash");
  const ProgramResult told = runHaptolith(fmt::format("replay '{}'", file("run.h5")));
  EXPECT_EQ(told.exit_status, 0);
  EXPECT_THAT(told.output, HasSubstr("differs    in tick 400 at 0.401 s: state_hash"));
}

/// `./dev hashes` renews the file when the bits change.
TEST_F(ReplayCommand, ARecordingOfAnotherMachineIsVerifiedWithOtherInstructionSets) {
  const std::string recording = (sourceDir() / "tests" / "data" / "recorded.h5").string();
  const ProgramResult result =
      runInShell(fmt::format("HAPTOLITH_SIMD=SCALAR \"$HAPTOLITH\" replay --verify --json '{}'", recording));
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json summary = json::parse(result.output);
  EXPECT_NE(summary["recorded_simd"], "SCALAR");
  EXPECT_EQ(summary["simd"], "SCALAR");
  EXPECT_EQ(summary["recorded_arithmetic"], "fused");
  EXPECT_EQ(summary["hashes"], 1000);
  EXPECT_TRUE(summary["difference"].is_null());
  EXPECT_EQ(runHaptolith(fmt::format("replay --verify '{}'", recording)).exit_status, 0) << "best of this machine";
}

TEST_F(ReplayCommand, AChangedByteIsToldWithItsTicks) {
  std::string bytes = bytesOf((sourceDir() / "tests" / "data" / "recorded.h5").string());
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  std::ofstream(file("changed.h5"), std::ios::binary) << bytes;
  const ProgramResult result = runHaptolith(fmt::format("replay --verify '{}'", file("changed.h5")));
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.errors, HasSubstr("/ticks is damaged in rows 0 to 999"));
}

TEST_F(ReplayCommand, ALargeRecordedSceneOfAFileIsTheSameAgain) {
  std::ofstream(file("scene.toml")) << R"(
title = "A large bed"
[bed]
width_mm = 400
length_mm = 400
particles = 3000
layers = 4
threads = 2
)";
  const json run = recorded(fmt::format("'{}' --motion press --no-realtime --duration-s 0.8", file("scene.toml")));
  EXPECT_EQ(run.at("threads"), 2);
  fs::remove(file("scene.toml"));  // the recording has all of it
  for (const int threads : {1, 3}) {
    const json replay = verified(fmt::format("--threads {}", threads));
    EXPECT_EQ(replay.at("title"), "A large bed");
    EXPECT_EQ(replay.at("replayed_ticks"), 800);
    EXPECT_TRUE(replay.at("difference").is_null());
  }
}

TEST_F(ReplayCommand, ARunByTheClockUnderADeviceThatNobodyHoldsIsStaleThroughout) {
  const json run = recorded("icra2021 --device network --device-address 127.0.0.1:0 --duration-s 0.3");
  EXPECT_EQ(run.at("force_n").at("max"), 0);
  const std::vector<json> rows = ticks();
  EXPECT_EQ(rows.size(), run.at("ticks"));
  for (const json& row : rows) {
    ASSERT_EQ(row.at("device_state"), 1);
    ASSERT_EQ(row.at("trip"), 2);
    ASSERT_EQ(row.at("felt_fz_n"), 0);
  }
  EXPECT_EQ(verified().at("replayed_ticks"), run.at("ticks"));
}

TEST_F(ReplayCommand, AFileIsOverwrittenOnlyWhenThatIsAskedFor) {
  const std::string run = fmt::format(
      "run icra2021 --motion still --no-realtime --no-serve --duration-s 0.05 --record '{}'", file("run.h5"));
  ASSERT_EQ(runHaptolith(run).exit_status, 0);
  const std::string only_copy = bytesOf(file("run.h5"));
  const ProgramResult refused = runHaptolith(run);
  EXPECT_EQ(refused.exit_status, 1);
  EXPECT_THAT(refused.errors, AllOf(HasSubstr(file("run.h5")), HasSubstr("already exists")));
  EXPECT_THAT(refused.output, IsEmpty());
  EXPECT_EQ(bytesOf(file("run.h5")), only_copy);
  EXPECT_THAT(files(), ElementsAre("run.h5"));

  EXPECT_EQ(runHaptolith(run + " --overwrite").exit_status, 0);
  EXPECT_EQ(verified().at("replayed_ticks"), 50);
  EXPECT_THAT(files(), ElementsAre("run.h5"));
}

TEST_F(ReplayCommand, WhereNothingCanBeWrittenNothingRuns) {
  const ProgramResult missing = runHaptolith(fmt::format(
      "run icra2021 --no-realtime --no-serve --duration-s 0.05 --record '{}'", file("no/such/folder/run.h5")));
  EXPECT_EQ(missing.exit_status, 1);
  EXPECT_THAT(missing.errors, AllOf(HasSubstr(file("no/such/folder/run.h5")), HasSubstr("No such file or directory")));
  EXPECT_THAT(missing.output, IsEmpty());
  EXPECT_THAT(files(), IsEmpty());

  const ProgramResult folder = runHaptolith(fmt::format(
      "run icra2021 --no-realtime --no-serve --duration-s 0.05 --overwrite --record '{}'", folder_.string()));
  EXPECT_EQ(folder.exit_status, 1);
  EXPECT_THAT(folder.errors, HasSubstr("not a regular file"));
}

TEST_F(ReplayCommand, PicturesAreTakenAsOftenAsAskedForAndNotAtAllForNone) {
  (void)recorded("icra2021 --motion press --duration-s 0.5 --record-frames 0");
  EXPECT_EQ(verified().at("replayed_ticks"), 500);
  const std::string export_all = fmt::format("export '{}' --format vtk --out '{}'", file("run.h5"), file("frames"));
  const ProgramResult none = runHaptolith(export_all);
  EXPECT_EQ(none.exit_status, 1);
  EXPECT_THAT(none.errors, HasSubstr("no frames"));

  (void)recorded("icra2021 --motion press --duration-s 0.5 --record-frames 20 --overwrite");
  ASSERT_EQ(runHaptolith(export_all).exit_status, 0);
  const auto pictures = std::ranges::count_if(fs::directory_iterator(file("frames")), [](const auto& entry) {
    return entry.path().extension() == ".vtu" && entry.path().filename().string().starts_with("particles");
  });
  EXPECT_GE(pictures, 3);  // 10 on a machine that is not busy
  EXPECT_LE(pictures, 12);

  EXPECT_EQ(runHaptolith(fmt::format("run icra2021 --record '{}' --record-frames 61", file("b.h5"))).exit_status, 2);
  EXPECT_EQ(runHaptolith(fmt::format("run icra2021 --record '{}' --record-frames -1", file("b.h5"))).exit_status, 2);
}

TEST_F(ReplayCommand, NonsenseIsRefused) {
  std::ofstream(file("text.h5")) << "no HDF5 at all";
  std::ofstream(file("empty.h5")).close();
  for (const std::string& name : {file("text.h5"), file("empty.h5"), file("missing.h5"), folder_.string()}) {
    const ProgramResult result = runHaptolith(fmt::format("replay '{}'", name));
    EXPECT_EQ(result.exit_status, 1) << name;
    EXPECT_THAT(result.errors, HasSubstr(name));
    EXPECT_THAT(result.output, IsEmpty());
  }
  EXPECT_EQ(runHaptolith("replay").exit_status, 2);
  EXPECT_EQ(runHaptolith(fmt::format("replay '{}' --threads 0", file("text.h5"))).exit_status, 2);
}

TEST_F(ReplayCommand, ATruncatedRecordingIsRefused) {
  (void)recorded("icra2021 --motion press --no-realtime --duration-s 0.5");
  const std::string whole = bytesOf(file("run.h5"));
  for (const std::size_t kept : {whole.size() / 10, whole.size() / 2, whole.size() - 100}) {
    std::ofstream(file("run.h5"), std::ios::binary) << whole.substr(0, kept);
    const ProgramResult result = runHaptolith(fmt::format("replay --verify '{}'", file("run.h5")));
    EXPECT_EQ(result.exit_status, 1) << kept;
    EXPECT_THAT(result.errors, HasSubstr(file("run.h5")));
  }
}

TEST_F(ReplayCommand, AKilledRunLeavesWhatCanBeExportedAndReplayed) {
  // Killed as soon as its first chunks are in the file, and some time later.
  const ProgramResult killed = runInShell(fmt::format(
      "\"$HAPTOLITH\" run icra2021 --motion stir --no-serve --record '{0}' & pid=$!; "
      "for i in $(seq 200); do [ -e '{0}' ] && break; sleep 0.1; done; sleep 1.3; kill -KILL $pid; wait $pid",
      file("run.h5")));
  EXPECT_EQ(killed.exit_status, 128 + 9) << killed.errors;
  const std::vector<json> rows = ticks();
  EXPECT_GT(rows.size(), 300U);
  const json replay = verified();
  EXPECT_EQ(replay.at("replayed_ticks"), rows.size());
  EXPECT_TRUE(replay.at("difference").is_null());
}

TEST_F(ReplayCommand, TicksThatAreMissingFailToVerify) {
  (void)recorded("icra2021 --motion press --no-realtime --duration-s 0.5");
  const ProgramResult cut =
      runInShell(fmt::format(R"(/usr/bin/python3 -c "import h5py; file = h5py.File('{}', 'r+'); )"
                             R"(ticks = file['ticks']; rows = ticks[:]; ticks.resize(400, 0); )"
                             R"(ticks[:] = rows[[*range(200), *range(300, 500)]]; del file.attrs['missing_ticks']")",
                             file("run.h5")));
  ASSERT_EQ(cut.exit_status, 0) << cut.errors;
  const ProgramResult failed = runHaptolith(fmt::format("replay --verify --json '{}'", file("run.h5")));
  EXPECT_EQ(failed.exit_status, 1);
  EXPECT_THAT(failed.errors, AllOf(HasSubstr("incomplete"), HasSubstr("100 ticks after 0.200 s")));
  EXPECT_EQ(json::parse(failed.output).at("missing_ticks"), 100);
  EXPECT_EQ(json::parse(failed.output).at("replayed_ticks"), 200);
  const ProgramResult told = runHaptolith(fmt::format("replay '{}'", file("run.h5")));
  EXPECT_EQ(told.exit_status, 0);
  EXPECT_THAT(told.output, HasSubstr("missing    100 ticks after 0.200 s"));
}

// The terminal has been stopped, as by Ctrl-S, and continues only when the recording is complete.
TEST_F(ReplayCommand, ATerminalThatNobodyReadsHoldsUpNoRecording) {
  std::ofstream(file("stopped.py")) << R"(
import os, pty, subprocess, sys, termios, time
program, recording = sys.argv[1:]
terminal, end = pty.openpty()
termios.tcflow(end, termios.TCOOFF)
run = subprocess.Popen([program, 'run', 'icra2021', '--motion', 'still', '--duration-s', '1', '--no-serve', '--record', recording],
                       stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=end)
complete = False
for _ in range(300):
    if os.path.exists(recording):
        with open(recording, 'rb') as file:
            complete = file.read(12)[11:] == b'\0'
    if complete:
        break
    time.sleep(0.1)
termios.tcflow(end, termios.TCOON)
os.close(end)
try:
    run.wait(20)
except subprocess.TimeoutExpired:
    run.kill()
sys.exit(0 if complete and run.returncode == 0 else 1)
)";
  const ProgramResult result =
      runInShell(fmt::format("/usr/bin/python3 '{}' \"$HAPTOLITH\" '{}'", file("stopped.py"), file("run.h5")));
  EXPECT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_EQ(verified().at("replayed_ticks"), 1000);
}

TEST_F(ReplayCommand, AnInterruptedRunKeepsItsRecording) {
  const ProgramResult interrupted = runInShell(
      fmt::format("timeout --preserve-status -s INT 1.5 \"$HAPTOLITH\" run icra2021 --json --motion stir --record '{}'",
                  file("run.h5")));
  EXPECT_EQ(interrupted.exit_status, 0) << interrupted.errors;
  EXPECT_EQ(verified().at("replayed_ticks"), json::parse(interrupted.output).at("ticks"));
}

}  // namespace
}  // namespace haptolith
