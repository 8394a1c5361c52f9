#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "../source_dir.h"
#include "program.h"

namespace haptolith {
namespace {

using nlohmann::json;
using testing::HasSubstr;
namespace fs = std::filesystem;

class RunCommand : public testing::Test {
 protected:
  RunCommand() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_run_{}", getpid())) {
    fs::create_directories(folder_);
  }
  ~RunCommand() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }

  void writeFile(const std::string& name, const std::string& text) const { std::ofstream(file(name)) << text; }

  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  static std::vector<std::vector<std::string>> readCsv(const std::string& path) {
    std::ifstream in(path);
    std::vector<std::vector<std::string>> rows;
    for (std::string line; std::getline(in, line);) {
      std::istringstream cells(line);
      rows.emplace_back();
      for (std::string cell; std::getline(cells, cell, ',');) {
        rows.back().push_back(cell);
      }
    }
    return rows;
  }

  static json summaryOf(const std::string& arguments) {
    const ProgramResult result = runHaptolith("run --json " + arguments);
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    return json::parse(result.output);
  }

  fs::path folder_;
};

TEST_F(RunCommand, SummaryTellsTheWholeRun) {
  const json summary = summaryOf("icra2021 --no-realtime --duration-s 2");
  EXPECT_EQ(summary["particles"], 256);
  EXPECT_EQ(summary["ticks"], 2000);
  EXPECT_DOUBLE_EQ(summary["duration_s"], 2);
  for (const char* key : {"mean", "p50", "p99", "p99_9", "max"}) {
    EXPECT_GT(summary["tick_us"][key].get<double>(), 0) << key;
  }
  for (const char* key : {"mean", "p99", "max"}) {
    EXPECT_GT(summary["force_n"][key].get<double>(), 0) << key;
    EXPECT_GT(summary["torque_nm"][key].get<double>(), 0) << key;
  }
  EXPECT_EQ(summary["state_hash"].get<std::string>().size(), 16U);
  EXPECT_TRUE(summary["deadline_misses"].is_null()) << "nothing is in step with the clock";
  EXPECT_TRUE(summary["success_rate_last_100"].is_null());
  EXPECT_TRUE(summary["realtime"]["scheduler"].is_string());
  EXPECT_TRUE(summary["realtime"]["memory_locked"].is_boolean());
}

TEST_F(RunCommand, MissedDeadlinesAreToldByTheirCause) {
  const json summary = summaryOf("icra2021 --duration-s 1");
  const auto misses = [&](const char* cause) { return summary[std::string("misses_") + cause].get<int>(); };
  EXPECT_EQ(misses("too_long") + misses("woken_late") + misses("preempted"), summary["deadline_misses"]);
  EXPECT_TRUE(summaryOf("icra2021 --no-realtime --duration-s 0.05")["misses_too_long"].is_null());
}

TEST_F(RunCommand, SoilTooFineForAnyMachineEndsWithAdvice) {
  const std::string fine =
      "run icra2021 --set bed.start=packed --set bed.width_mm=1000 --set bed.length_mm=1000 --set bed.depth_mm=150 "
      "--set bed.sleep=false --duration-s 0.2 --no-serve ";
  const ProgramResult text = runHaptolith(fine);
  ASSERT_EQ(text.exit_status, 0) << text.errors;
  EXPECT_THAT(text.output, HasSubstr("ticks too long, "));
  EXPECT_THAT(text.output, HasSubstr("the particles are too small for this machine: "));
  EXPECT_THAT(text.output, HasSubstr("try: --set soil.radius_mm=8.1\n"));
  EXPECT_THAT(json::parse(runHaptolith(fine + "--json").output)["advice"].get<std::string>(), HasSubstr("too small"));
}

TEST_F(RunCommand, WithoutANameOpensSoilAtRestThatPassesTheLaboratory) {
  const auto with_cache = [this](const std::string& scene) {
    const ProgramResult result = runInShell(fmt::format(
        "HAPTOLITH_CACHE='{}' \"$HAPTOLITH\" run {} --json --no-realtime --duration-s 0.05", folder_.string(), scene));
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    return json::parse(result.output);
  };
  const json usual = with_cache("");
  EXPECT_EQ(usual["state_hash"], with_cache("auto")["state_hash"]) << "measured once";
  EXPECT_EQ(files().size(), 1U) << "no tile had to settle";
  EXPECT_EQ(usual["soil"], "lunar-0-15cm");
  EXPECT_EQ(usual["friction"], "contact");
  EXPECT_EQ(usual["awake"], 0) << "it lies still until it is touched";
  const json regolith = summaryOf("regolith --no-realtime --duration-s 0.05");
  EXPECT_TRUE(regolith["finest"].is_null());
  EXPECT_GT(regolith["particles"].get<int>() - regolith["held"].get<int>(), 1500);
}

TEST_F(RunCommand, SaysWhichParticlesItChoseAndTakesCoarserOnes) {
  const ProgramResult chosen = runHaptolith("run --no-realtime --duration-s 0.01 --no-serve");
  EXPECT_EQ(chosen.exit_status, 0) << chosen.errors;
  EXPECT_THAT(chosen.errors, testing::ContainsRegex("mm particles on [0-9]+ thread.*this machine"));
  const auto particles = [](const std::string& arguments) {
    return summaryOf(arguments + " --no-realtime --duration-s 0.01")["particles"].get<int>();
  };
  EXPECT_EQ(particles("--set soil.radius_mm=4 --coarser"), particles("--set soil.radius_mm=4.4"));
  EXPECT_EQ(particles("--set soil.radius_mm=4 --coarser --coarser"), particles("--set soil.radius_mm=4.8"));
  const ProgramResult said =
      runHaptolith("run --set soil.radius_mm=4 --coarser --no-realtime --duration-s 0.01 --no-serve");
  EXPECT_THAT(said.errors, HasSubstr("4.4 mm particles on"));
  const ProgramResult refused = runHaptolith("run icra2021 --coarser --no-realtime --duration-s 0.01");
  EXPECT_EQ(refused.exit_status, 2);
}

TEST_F(RunCommand, APresetWithoutASceneIsThePapersSoilInThePapersScene) {
  EXPECT_EQ(summaryOf("--no-realtime --duration-s 0.05 --preset P1")["state_hash"],
            summaryOf("icra2021 --no-realtime --duration-s 0.05 --preset P1")["state_hash"]);
}

TEST_F(RunCommand, AnyKeyCanBeSetOnTheCommandLine) {
  const json summary = summaryOf(
      "--no-realtime --duration-s 0.01 --set bed.particles=200 --set soil.preset=P1 --set gravity.body=Mars icra2021");
  EXPECT_EQ(summary["particles"], 200);
  EXPECT_EQ(summary["preset"], "P1");
  const ProgramResult wrong = runHaptolith("run icra2021 --set bed.threads=0");
  EXPECT_EQ(wrong.exit_status, 2);
  EXPECT_THAT(wrong.errors, HasSubstr("override bed.threads=0: [bed] threads = 0 is not valid"));
  const ProgramResult unknown = runHaptolith("run icra2021 --set bed.treads=2");
  EXPECT_EQ(unknown.exit_status, 2);
  EXPECT_THAT(unknown.errors, HasSubstr("did you mean [bed] threads?"));
}

TEST_F(RunCommand, AutoResolutionChoosesGrainsAndSaysWhich) {
  const json run = summaryOf("regolith --auto-resolution --no-realtime --duration-s 0.05");
  const double radius_mm = run["finest"]["chosen"]["radius_mm"];
  EXPECT_THAT(
      run["title"].get<std::string>(),
      HasSubstr(radius_mm == 3.5 ? "Lunar soil" : fmt::format(" soil, Moon, R = {:.3g} mm, shovel", radius_mm)));
  // On a busy machine it chooses 7 mm, of which this bed holds two layers and a half: 161 where 199 are foreseen.
  const double error = radius_mm < 7 ? 0.1 : 0.25;
  const double free = run["particles"].get<double>() - run["held"].get<double>();
  EXPECT_NEAR(free / run["finest"]["chosen"]["grains"].get<double>(), 1, error);
  EXPECT_TRUE(summaryOf("icra2021 --no-realtime --duration-s 0.05")["finest"].is_null());
  const ProgramResult refused = runHaptolith("run icra2021 --auto-resolution --no-realtime --duration-s 0.05");
  EXPECT_EQ(refused.exit_status, 2);
  EXPECT_THAT(refused.errors, HasSubstr("the bed must start as settled"));
}

TEST_F(RunCommand, StateHashDependsOnTheSceneAndOnNothingElse) {
  const std::string scoop = "icra2021 --no-realtime --duration-s 3 --motion scoop";
  const json once = summaryOf(scoop);
  EXPECT_EQ(once["state_hash"], summaryOf(scoop)["state_hash"]);
  EXPECT_EQ(once["state_hash"], summaryOf(scoop + " --threads 3")["state_hash"]);
  EXPECT_EQ(once["state_hash"], summaryOf("icra2021 --duration-s 3 --motion scoop")["state_hash"])
      << "pacing changes the physics";
  EXPECT_NE(once["state_hash"], summaryOf(scoop + " --body Mars")["state_hash"]);
  EXPECT_NE(once["state_hash"], summaryOf(scoop + " --preset P1")["state_hash"]);
}

TEST_F(RunCommand, ASoilIsFoundByItsNameFromAnyFolder) {
  const ProgramResult result = runInShell(fmt::format(
      "cd '{}' && \"$HAPTOLITH\" run icra2021 --json --no-realtime --duration-s 0.05 --soil LHS-1", folder_.string()));
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json summary = json::parse(result.output);
  EXPECT_EQ(summary["soil"], "lhs-1");
  EXPECT_EQ(summary["preset"], "");
  EXPECT_EQ(summary["friction"], "contact");
}

TEST_F(RunCommand, ASoilMayComeFromAFileAndReplacesTheScenes) {
  const ProgramResult copied = runInShell(fmt::format(
      "sed 's/^name = .*/name = \"mine\"/' '{}/soils/lhs-1.toml' > '{}'", sourceDir().string(), file("mine.toml")));
  ASSERT_EQ(copied.exit_status, 0);
  const std::string brief = "--no-realtime --duration-s 0.05 ";
  EXPECT_EQ(summaryOf(brief + "icra2021 --soil " + file("mine.toml"))["soil"], "mine");
  EXPECT_EQ(summaryOf(brief + "icra2021 --soil " + file("mine.toml"))["state_hash"],
            summaryOf(brief + "icra2021 --soil lhs-1")["state_hash"]);
  writeFile("scene.toml", "[soil]\nfile = \"mine.toml\"\n");
  EXPECT_EQ(summaryOf(brief + file("scene.toml"))["soil"], "mine");
  EXPECT_EQ(summaryOf(brief + file("scene.toml") + " --soil jsc-1a")["soil"], "jsc-1a");
  const json preset = summaryOf(brief + file("scene.toml") + " --preset P2");
  EXPECT_TRUE(preset["soil"].is_null());
  EXPECT_EQ(preset["preset"], "P2");
  EXPECT_EQ(preset["friction"], "icra2021");
}

TEST_F(RunCommand, FrictionIsTheSoilsUnlessToldOtherwise) {
  const std::string brief = "icra2021 --no-realtime --duration-s 0.05 ";
  EXPECT_EQ(summaryOf(brief)["friction"], "icra2021");
  EXPECT_EQ(summaryOf(brief + "--friction-model Contact")["friction"], "contact");
  EXPECT_EQ(summaryOf(brief + "--friction pairwise")["friction"], "contact") << "the word of earlier versions";
  EXPECT_EQ(summaryOf(brief + "--friction-model contact")["preset"], "P3");
  EXPECT_EQ(summaryOf(brief + "--soil lms-1 --friction-model icra2021")["friction"], "icra2021");
}

TEST_F(RunCommand, AWrongSoilIsToldWithTheNearest) {
  const ProgramResult unknown = runHaptolith("run icra2021 --soil jsc-1b");
  EXPECT_EQ(unknown.exit_status, 2);
  EXPECT_THAT(unknown.errors, HasSubstr("soil = 'jsc-1b' is not valid: must be one of apollo-15-srp, "));
  EXPECT_THAT(unknown.errors, HasSubstr("did you mean jsc-1a?"));
  writeFile("wrong.toml", "name = \"x\"\n[target]\ncohesion_pa = -1\n");
  const ProgramResult wrong = runHaptolith("run icra2021 --soil " + file("wrong.toml"));
  EXPECT_EQ(wrong.exit_status, 2);
  EXPECT_THAT(wrong.errors, HasSubstr("wrong.toml:3: [target] cohesion_pa = -1 is not valid: must be 0 to 1000000"));
}

TEST_F(RunCommand, SeedChangesRainAndNothingElse) {
  writeFile("rain.toml", "[bed]\nstart = \"rain\"\nparticles = 60\nwidth_mm = 80\nlength_mm = 80\n");
  const std::string rain = "--no-realtime --duration-s 0.01 " + file("rain.toml");
  EXPECT_EQ(summaryOf(rain + " --seed 5")["state_hash"], summaryOf(rain + " --seed 5")["state_hash"]);
  EXPECT_NE(summaryOf(rain + " --seed 5")["state_hash"], summaryOf(rain + " --seed 6")["state_hash"]);
}

TEST_F(RunCommand, AToolThatSomebodyDrewIsToldOfAndReplayedWithoutItsFile) {
  writeFile("wedge.obj", "v 0 0 0\nv 30 0 0\nv 0 20 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const ProgramResult run = runHaptolith(fmt::format(
      "run icra2021 --set tool.mesh={} --no-realtime --duration-s 0.5 --record {}", file("wedge.obj"), file("run.h5")));
  EXPECT_EQ(run.exit_status, 0) << run.errors;
  EXPECT_THAT(run.errors, HasSubstr("wedge.obj: 30 x 20 x 10 mm"));
  ASSERT_EQ(runInShell(fmt::format("rm '{}'", file("wedge.obj"))).exit_status, 0);
  const ProgramResult replay = runHaptolith("replay " + file("run.h5"));
  EXPECT_EQ(replay.exit_status, 0) << replay.errors;
  EXPECT_THAT(replay.output, HasSubstr("500 of 500 ticks"));
}

TEST_F(RunCommand, TraceHasARowForEveryTickAndIsAPoseFile) {
  summaryOf("icra2021 --no-realtime --duration-s 1.5 --trace " + file("trace.csv"));
  EXPECT_EQ(files(), std::vector<std::string>{"trace.csv"});
  const auto rows = readCsv(file("trace.csv"));
  ASSERT_EQ(rows.size(), 1501U);
  EXPECT_EQ(rows[0][0], "t_s");
  EXPECT_EQ(rows[0].size(), 21U);
  EXPECT_EQ(std::stod(rows[1500][0]), 1.5);

  const ProgramResult cut = runInShell(fmt::format("cut -d, -f1-8 '{}' > '{}'", file("trace.csv"), file("poses.csv")));
  ASSERT_EQ(cut.exit_status, 0);
  const json replay = summaryOf("icra2021 --no-realtime --poses " + file("poses.csv"));
  EXPECT_EQ(replay["ended"], "end of the recorded movement");
}

TEST_F(RunCommand, FigureIsDrawn) {
  summaryOf(fmt::format("icra2021 --no-realtime --duration-s 1 --figure {}", file("run.svg")));
  std::ifstream in(file("run.svg"));
  const std::string svg{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  EXPECT_THAT(svg, HasSubstr("Force on the hand"));
  EXPECT_EQ(files(), std::vector<std::string>{"run.svg"});
}

// The plate's movement is real (scenes/plate-recorded.csv); the bed's answer must be force that grows with sinkage.
TEST_F(RunCommand, PlateWithARecordedMovementFeelsForceThatGrowsWithSinkage) {
  summaryOf(
      fmt::format("--no-realtime --trace {} {}/scenes/plate-recorded.toml", file("plate.csv"), sourceDir().string()));
  constexpr double kStartHeight_m = 0.117188 + 0.0025;  // the plate's centre at no sinkage
  std::vector<double> sum(4), count(4);                 // in bins of 9 mm of sinkage
  const auto rows = readCsv(file("plate.csv"));
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double sinkage = kStartHeight_m - std::stod(rows[i][3]);
    const auto bin = static_cast<std::size_t>(sinkage / 0.009);
    if (sinkage >= 0 && bin < sum.size()) {
      sum[bin] += std::stod(rows[i][10]);
      ++count[bin];
    }
    if (sinkage < -0.001) {
      EXPECT_EQ(std::stod(rows[i][10]), 0) << "above the bed, row " << i;
    }
  }
  for (std::size_t bin = 1; bin < sum.size(); ++bin) {
    EXPECT_GT(sum[bin] / count[bin], 1.2 * sum[bin - 1] / count[bin - 1]) << "bin " << bin;
  }
  EXPECT_GT(sum[3] / count[3], 10);
}

TEST_F(RunCommand, CtrlCEndsAnEndlessRunWithItsSummary) {
  const ProgramResult result = runInShell(fmt::format(
      "timeout --preserve-status -s INT 2 \"$HAPTOLITH\" run icra2021 --json --trace {}", file("trace.csv")));
  EXPECT_EQ(result.exit_status, 0) << result.errors;
  const json summary = json::parse(result.output);
  EXPECT_EQ(summary["ended"], "stopped");
  EXPECT_EQ(readCsv(file("trace.csv")).size(), summary["ticks"].get<std::size_t>() + 1);
  EXPECT_EQ(files(), std::vector<std::string>{"trace.csv"});
}

TEST_F(RunCommand, CtrlCStillDrawsTheFigureAndPrintsTheSummary) {
  const ProgramResult result = runInShell(fmt::format(
      "timeout --preserve-status -s INT 3 \"$HAPTOLITH\" run icra2021 --no-serve --figure {}", file("run.svg")));
  EXPECT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("stopped"));
  EXPECT_EQ(files(), std::vector<std::string>{"run.svg"});
}

TEST_F(RunCommand, AClosedTerminalEndsARunAndItsTraceIsKept) {
  const ProgramResult result = runInShell(fmt::format(
      "timeout --preserve-status -s HUP 2 \"$HAPTOLITH\" run icra2021 --json --trace {}", file("trace.csv")));
  EXPECT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_EQ(readCsv(file("trace.csv")).size(), json::parse(result.output)["ticks"].get<std::size_t>() + 1);
}

TEST_F(RunCommand, ARunCutShortHasFailedButKeepsWhatItHas) {
  for (const char* signal : {"INT", "TERM"}) {
    const ProgramResult result = runInShell(fmt::format(
        "timeout --preserve-status -s {} 2 \"$HAPTOLITH\" run icra2021 --duration-s 1000 --overwrite --trace {}",
        signal, file("trace.csv")));
    EXPECT_EQ(result.exit_status, 1) << signal;
    EXPECT_THAT(result.errors, HasSubstr("interrupted after"));
    EXPECT_THAT(result.errors, HasSubstr("of 1000 s"));
    EXPECT_GT(readCsv(file("trace.csv")).size(), 100U);
    EXPECT_EQ(files(), std::vector<std::string>{"trace.csv"});
  }
}

TEST_F(RunCommand, AFullDiskIsAFailureAndLeavesNothingBehind) {
  // A file may not grow beyond 8 blocks of 1 KiB here; the signal for that is ignored, so that write() fails.
  const ProgramResult result =
      runInShell(fmt::format("bash -c 'trap \"\" XFSZ; ulimit -f 8; exec \"$HAPTOLITH\" run icra2021 --no-realtime "
                             "--duration-s 60 --trace {}'",
                             file("trace.csv")));
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.errors, HasSubstr("cannot write"));
  EXPECT_THAT(result.errors, HasSubstr("trace.csv"));
  EXPECT_TRUE(files().empty()) << files().front();
}

TEST_F(RunCommand, AnOldTraceStaysWhenTheNewOneFails) {
  writeFile("trace.csv", "precious\n");
  runInShell(
      fmt::format("bash -c 'trap \"\" XFSZ; ulimit -f 8; exec \"$HAPTOLITH\" run icra2021 --no-realtime --duration-s "
                  "60 --trace {}'",
                  file("trace.csv")));
  EXPECT_EQ(readCsv(file("trace.csv"))[0][0], "precious");
}

TEST_F(RunCommand, FilesThatCannotBeWrittenAreRefusedAtOnce) {
  const ProgramResult trace =
      runHaptolith("run icra2021 --no-realtime --duration-s 1000 --trace /no/such/folder/t.csv");
  EXPECT_EQ(trace.exit_status, 1);
  EXPECT_THAT(trace.errors, HasSubstr("/no/such/folder/t.csv"));
  const ProgramResult figure = runHaptolith("run icra2021 --no-realtime --duration-s 1000 --figure " + file("run.gif"));
  EXPECT_EQ(figure.exit_status, 2);
  EXPECT_THAT(figure.errors, HasSubstr(".svg or .png"));
  const ProgramResult lost =
      runHaptolith("run icra2021 --no-realtime --duration-s 1000 --figure /no/such/folder/run.png");
  EXPECT_EQ(lost.exit_status, 1);
}

TEST_F(RunCommand, BadPosesAreToldWithFileLineAndColumn) {
  const std::string header = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
  const struct {
    const char* text;
    const char* told;
  } cases[] = {{"0,0,0,0.1,1,0,0,0\n1,0,nan,0.1,1,0,0,0\n", ":3: column y_m"},
               {"0,0,0,0.1,1,0,0,0\n0,0,0,0.1,1,0,0,0\n", "time goes forward"},
               {"0,0,0,0.1,1,0,0,0\n1,0,0,0.1,0,0,0,0\n", "qw,qx,qy,qz"},
               {"0,0,0,0.1,1,0,0\n", "8 cells"},
               {"", "at least 2"}};
  for (const auto& [text, told] : cases) {
    writeFile("poses.csv", header + text);
    const ProgramResult result = runHaptolith("run icra2021 --no-realtime --poses " + file("poses.csv"));
    EXPECT_EQ(result.exit_status, 2) << text;
    EXPECT_THAT(result.errors, HasSubstr(told));
    EXPECT_THAT(result.errors, HasSubstr("poses.csv"));
  }
  EXPECT_EQ(runHaptolith("run icra2021 --poses /no/such/poses.csv").exit_status, 2);
  writeFile("poses.csv", "");
  EXPECT_EQ(runHaptolith("run icra2021 --poses " + file("poses.csv")).exit_status, 2);
}

TEST_F(RunCommand, AHandThatLeavesTheSceneEndsTheRun) {
  writeFile("poses.csv", "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0.2,1,0,0,0\n1,5,0,0.2,1,0,0,0\n");
  const ProgramResult result = runHaptolith("run icra2021 --no-realtime --json --poses " + file("poses.csv"));
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.errors, HasSubstr("the hand left the scene"));
  EXPECT_TRUE(json::accept(result.output)) << "the summary is printed all the same";
}

TEST_F(RunCommand, WrongUseIsToldAndHasStatusTwo) {
  for (const char* arguments :
       {"--preset P9", "--soil none.toml", "--soil lhs-1 --preset P1", "--friction-model none", "--body Vulcan",
        "--motion dance", "--cpu one", "--cpu -2", "--cpu 1024", "--duration-s nan", "--duration-s -1", "--threads 0",
        "--threads two", "--seed -1", "--motion stir --poses x.csv", "one.toml two.toml"}) {
    const ProgramResult result = runInShell(std::string("timeout 20 \"$HAPTOLITH\" run --no-realtime ") + arguments);
    EXPECT_EQ(result.exit_status, 2) << arguments;
    EXPECT_THAT(result.errors, HasSubstr("error:")) << arguments;
    EXPECT_TRUE(result.output.empty()) << arguments;
  }
}

TEST_F(RunCommand, ServesItsPageAndSaysWhere) {
  // The address is read from standard error while the program runs; bash can request a page.
  const std::string ask = R"( 2> $0.log & trap "rm -f $0.log" EXIT
    for i in $(seq 100); do port=$(sed -nE "s|.*http://127.0.0.1:([0-9]+)/.*|\1|p" $0.log); [ "$port" ] && break; sleep 0.05; done
    exec 3<>/dev/tcp/127.0.0.1/$port; printf "GET / HTTP/1.0\r\nHost: localhost\r\n\r\n" >&3; cat <&3; kill -INT %1; wait)";
  const auto served = [&](const std::string& arguments) {
    return runInShell("bash -c 'set -m; \"$HAPTOLITH\" run icra2021 --port 0 " + arguments + ask + "' " +
                      file("serve"));
  };
  const ProgramResult result = served("--motion still");
  EXPECT_THAT(result.output, HasSubstr("200 OK"));
  EXPECT_THAT(result.output, HasSubstr("<title>haptolith"));
  EXPECT_THAT(served("--json --no-realtime --serve").output, HasSubstr("200 OK"));

  EXPECT_THAT(runHaptolith("run icra2021 --duration-s 0.1 --json").errors, testing::Not(HasSubstr("http://")));
  EXPECT_THAT(runHaptolith("run icra2021 --duration-s 0.1 --no-serve").errors, testing::Not(HasSubstr("http://")));
}

TEST_F(RunCommand, BeyondThisMachineTheAddressHasAToken) {
  const ProgramResult made_up = runHaptolith("run icra2021 --duration-s 0.1 --port 0 --bind 0.0.0.0");
  EXPECT_THAT(made_up.errors, testing::ContainsRegex("http://[0-9.]+:[0-9]+/\\?token=[0-9a-f]{32}"));
  const ProgramResult wrong = runHaptolith("run icra2021 --duration-s 0.1 --bind everywhere");
  EXPECT_EQ(wrong.exit_status, 2);
  EXPECT_THAT(wrong.errors, HasSubstr("bind = everywhere"));
  EXPECT_EQ(runHaptolith("run icra2021 --duration-s 0.1 --port 65536").exit_status, 2);
  EXPECT_EQ(runHaptolith("run icra2021 --duration-s 0.1 --serve --no-serve").exit_status, 2);
}

TEST_F(RunCommand, ATokenMayBeGivenWhereNoListOfProcessesShowsIt) {
  const std::string run = "\"$HAPTOLITH\" run icra2021 --duration-s 0.1 --port 0 ";
  for (const std::string& command :
       {run + "--token dust_of_the-Moon0", "echo dust_of_the-Moon0 | " + run + "--token-file /dev/stdin",
        "HAPTOLITH_TOKEN=dust_of_the-Moon0 " + run}) {
    EXPECT_THAT(runInShell(command).errors, HasSubstr("/?token=dust_of_the-Moon0\n")) << command;
  }
  for (const auto& [command, told] :
       {std::pair<std::string, std::string>{run + "--token moon", "token = a text of 4 characters"},
        {run + "--token 'a b c d e f g h i'", "16 to 128 of A to Z, a to z, 0 to 9, - and _"},
        {"HAPTOLITH_TOKEN=secret " + run, "HAPTOLITH_TOKEN = a text of 6 characters"},
        {run + "--token-file /dev/null", "/dev/null = a text of 0 characters"},
        {run + "--token-file /dev/zero", "/dev/zero = a text with other characters"},
        {run + "--token a --token-file b", "--token"}}) {
    const ProgramResult wrong = runInShell(command);
    EXPECT_EQ(wrong.exit_status, 2) << command;
    EXPECT_THAT(wrong.errors, testing::AllOf(HasSubstr(told), testing::Not(HasSubstr("secret")))) << command;
  }
  const ProgramResult missing = runInShell(run + "--token-file no-such-file");
  EXPECT_EQ(missing.exit_status, 1);
  EXPECT_THAT(missing.errors, HasSubstr("cannot read no-such-file"));
}

TEST_F(RunCommand, WhoMayOnlyLookOnIsNotInvitedToTouch) {
  EXPECT_THAT(runHaptolith("run icra2021 --duration-s 0.1 --port 0 --read-only").errors,
              HasSubstr("see it at http://127.0.0.1:"));
}

TEST_F(RunCommand, TellsHowLateItsTicksBegan) {
  const json real_time = summaryOf("icra2021 --duration-s 0.2");
  for (const char* key : {"mean", "p50", "p99", "p99_9", "max"}) {
    EXPECT_GT(real_time["late_us"][key].get<double>(), 0) << key;
  }
  std::uint64_t counted = 0;
  for (const json& count : real_time["late_us"]["buckets"]["count"]) {
    counted += count.get<std::uint64_t>();
  }
  EXPECT_EQ(counted, real_time["ticks"]);
  EXPECT_TRUE(summaryOf("icra2021 --duration-s 0.2 --no-realtime")["late_us"].is_null());
  EXPECT_THAT(runHaptolith("run icra2021 --duration-s 0.1 --no-serve").output,
              testing::ContainsRegex("\n  wake-up    p50 [0-9.]+  p99 [0-9.]+  p99.9 [0-9.]+  max [0-9.]+ us late\n"));
  EXPECT_THAT(runHaptolith("run icra2021 --duration-s 0.1 --no-realtime").output, testing::Not(HasSubstr("wake-up")));
}

TEST_F(RunCommand, RunsOnTheCpuItIsTold) {
  EXPECT_TRUE(summaryOf("icra2021 --no-realtime --duration-s 0.05")["realtime"]["cpu"].is_null());
  EXPECT_EQ(summaryOf("icra2021 --no-realtime --duration-s 0.05 --cpu 0")["realtime"]["cpu"], 0);
  EXPECT_THAT(runHaptolith("run icra2021 --duration-s 0.1 --no-serve --cpu 0").output, HasSubstr(" on CPU 0, memory "));
  writeFile("pinned.toml", "[loop]\ncpu = 0\n");
  EXPECT_EQ(summaryOf("--no-realtime --duration-s 0.05 " + file("pinned.toml"))["realtime"]["cpu"], 0);
  EXPECT_TRUE(
      summaryOf("--no-realtime --duration-s 0.05 --cpu -1 " + file("pinned.toml"))["realtime"]["cpu"].is_null());

  const ProgramResult none = runHaptolith("run icra2021 --duration-s 0.1 --cpu 1023");
  EXPECT_EQ(none.exit_status, 2);
  EXPECT_THAT(none.errors, HasSubstr("cpu = 1023 is not valid: must be -1 (any) or a CPU that this process may use: "));
}

TEST_F(RunCommand, UsesTheInstructionSetItIsToldTo) {
  const ProgramResult refused = runInShell("HAPTOLITH_SIMD=MMX \"$HAPTOLITH\" run icra2021 --duration-s 0.1 --json");
  EXPECT_EQ(refused.exit_status, 2);
  ASSERT_THAT(refused.errors, HasSubstr("HAPTOLITH_SIMD = MMX is not valid: must be one of "));
  const std::string last = refused.errors.substr(0, refused.errors.find(" on this machine"));
  const std::string target = last.substr(last.find_last_of(' ') + 1);
  const ProgramResult result =
      runInShell("HAPTOLITH_SIMD=" + target + " \"$HAPTOLITH\" run icra2021 --duration-s 0.1 --no-realtime --json");
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_EQ(json::parse(result.output).at("simd"), target);
}

// --- what comes from strangers ---

TEST_F(RunCommand, ASceneRunsNoCommand) {
  writeFile("gp.toml", fmt::format("title = \"A nice scene\\nsystem(\\\"touch {}\\\")\\n#\"\n", file("pwned")));
  const ProgramResult result =
      runHaptolith(fmt::format("run '{}' --motion press --duration-s 0.05 --no-realtime --no-serve --figure '{}'",
                               file("gp.toml"), file("g.svg")));
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.errors, HasSubstr("gp.toml:1: title"));
  EXPECT_EQ(files(), std::vector<std::string>{"gp.toml"});
}

TEST_F(RunCommand, ASceneLoadsNoLibrary) {
  writeFile("x.toml", "[device]\nkind = 'force-dimension'\nlibrary = './evil.so'\n");
  for (const char* command : {"run '{}' --duration-s 0.05 --no-realtime --no-serve", "snapshot '{}' --out x.png"}) {
    const ProgramResult result = runHaptolith(fmt::format(fmt::runtime(command), file("x.toml")));
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_THAT(result.errors, HasSubstr("x.toml:3: [device] library = './evil.so' is not valid"));
    EXPECT_THAT(result.errors, HasSubstr("--device-library"));
  }
}

TEST_F(RunCommand, PosesWithoutEndAreRefused) {
  fs::create_symlink("/dev/zero", file("zero.csv"));
  const ProgramResult result = runHaptolith(
      fmt::format("run icra2021 --poses '{}' --duration-s 0.05 --no-realtime --no-serve", file("zero.csv")));
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.errors, HasSubstr("zero.csv' is not valid: must be a file; it is a device"));
}

// --- what is there already ---

TEST_F(RunCommand, ReplacesNoFileUnlessItIsAskedTo) {
  writeFile("mine.csv", "mine");
  writeFile("mine.svg", "mine");
  for (const char* option : {"--trace", "--figure"}) {
    const std::string name = file(option == std::string("--trace") ? "mine.csv" : "mine.svg");
    const std::string command =
        fmt::format("run icra2021 --duration-s 0.02 --no-realtime --no-serve {} '{}'", option, name);
    const ProgramResult refused = runHaptolith(command);
    EXPECT_EQ(refused.exit_status, 1);
    EXPECT_THAT(refused.errors, HasSubstr("already exists: choose another name, or add --overwrite"));
    EXPECT_EQ(fs::file_size(name), 4U);
    EXPECT_EQ(runHaptolith(command + " --overwrite").exit_status, 0);
    EXPECT_GT(fs::file_size(name), 4U);
  }
}

TEST_F(RunCommand, NeverWritesOverTheSceneThatItRuns) {
  writeFile("x.toml", "title = 'mine'\n");
  const ProgramResult result = runHaptolith(
      fmt::format("run '{0}' --duration-s 0.02 --no-realtime --no-serve --overwrite --trace '{0}'", file("x.toml")));
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.errors, HasSubstr("x.toml: this command reads it"));
}

TEST_F(RunCommand, ARecordingIsNamedAsOneAndReplacesNothingElse) {
  const ProgramResult named =
      runHaptolith(fmt::format("run icra2021 --duration-s 0.02 --no-realtime --no-serve --record '{}'", file("x.csv")));
  EXPECT_EQ(named.exit_status, 2);
  EXPECT_THAT(named.errors, HasSubstr("a file name ending in .h5"));
  writeFile("notes.h5", "mine");
  const ProgramResult replaced = runHaptolith(fmt::format(
      "run icra2021 --duration-s 0.02 --no-realtime --no-serve --overwrite --record '{}'", file("notes.h5")));
  EXPECT_EQ(replaced.exit_status, 1);
  EXPECT_THAT(replaced.errors, HasSubstr("notes.h5: it is not a recording"));
  EXPECT_EQ(files(), std::vector<std::string>{"notes.h5"});
}

}  // namespace
}  // namespace haptolith
