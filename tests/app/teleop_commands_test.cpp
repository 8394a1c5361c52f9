#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "program.h"

namespace haptolith {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

TEST(TeleopCommands, ProfilesAreListed) {
  const ProgramResult table = runHaptolith("teleop link --list");
  EXPECT_EQ(table.exit_status, 0);
  EXPECT_THAT(table.output, AllOf(HasSubstr("earth-moon "), HasSubstr("2.6"), HasSubstr("outage")));
  const json profiles = json::parse(runHaptolith("teleop link --list --json").output).at("profiles");
  EXPECT_EQ(profiles.size(), 7U);
  EXPECT_EQ(profiles[0]["name"], "lan");
  EXPECT_NEAR(profiles[5]["loss"].get<double>(), 0.03, 1e-12);
}

TEST(TeleopCommands, FormerNamesStillWork) {
  const ProgramResult profiles = runHaptolith("teleop profiles --json");
  EXPECT_EQ(profiles.exit_status, 0) << profiles.errors;
  EXPECT_EQ(json::parse(profiles.output).at("profiles").size(), 7U);
  EXPECT_THAT(profiles.errors, HasSubstr("teleop profiles is now teleop link --list"));
  const ProgramResult robot = runHaptolith("teleop remote paper --listen 0.0.0.0:7410 --duration-s 1");
  EXPECT_THAT(robot.errors, AllOf(HasSubstr("teleop remote is now teleop robot"), HasSubstr("--key-file")));
  const ProgramResult link = runHaptolith("teleop link --to here");
  EXPECT_THAT(link.errors, AllOf(HasSubstr("--to is now --connect"), HasSubstr("HOST:PORT")));
  const ProgramResult bench = runHaptolith("teleop bench --case both,model --lets-go-s 1 --task press");
  EXPECT_THAT(bench.errors, AllOf(HasSubstr("both is now calibrated+adaptive"), HasSubstr("model is now static"),
                                  HasSubstr("--release-s = 1 is not valid")));
}

TEST(TeleopCommands, ALinkStandsBetweenTwoPrograms) {
  // A robot that answers, an operator that sends 20 packets 10 ms apart and waits for the answers.
  const std::filesystem::path script =
      std::filesystem::path(testing::TempDir()) / ("haptolith-link-" + std::to_string(getpid()) + ".py");
  std::ofstream(script) << R"(import json, socket, subprocess, sys, threading, time
robot = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); robot.bind(('127.0.0.1', 0)); robot.settimeout(5)
link = subprocess.Popen([sys.argv[1], 'teleop', 'link', '--listen', '127.0.0.1:0', '--connect', '127.0.0.1:%d' % robot.getsockname()[1],
                         '--profile', 'gateway', '--loss', '0', '--round-trip-s', '0.2', '--jitter-ms', '0',
                         '--duration-s', '2.5', '--json'], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
said = link.stderr.readline()
port = int(said.split('from port ')[1].split(' ')[0])
def answer():
    for _ in range(20):
        data, sender = robot.recvfrom(2000); robot.sendto(data.upper(), sender)
threading.Thread(target=answer, daemon=True).start()
operator = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); operator.settimeout(5)
sent = {}
for i in range(20):
    sent[b'PACKET %d' % i] = time.monotonic(); operator.sendto(b'packet %d' % i, ('127.0.0.1', port)); time.sleep(0.01)
took = [-sent[operator.recv(2000)] + time.monotonic() for _ in range(20)]  # what came first, then the time
print(json.dumps({'fastest_s': min(took), 'counts': json.loads(link.communicate()[0]), 'status': link.returncode}))
)";
  const ProgramResult result = runInShell("python3 " + script.string() + " \"$HAPTOLITH\"");
  std::filesystem::remove(script);
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json seen = json::parse(result.output);
  EXPECT_GE(seen["fastest_s"].get<double>(), 0.2);
  EXPECT_EQ(seen["status"], 0);
  EXPECT_EQ(seen["counts"]["up"]["arrived"], 20);
  EXPECT_EQ(seen["counts"]["down"]["arrived"], 20);
  EXPECT_EQ(seen["counts"]["ignored"], 0);
}

TEST(TeleopCommands, TheBenchComparesAndKeepsItsFiles) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("haptolith-bench-" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  const std::string bench = "teleop bench --model icra2021 --site icra2021 --duration-s 3 --round-trip-s 0.4,1 --csv " +
                            (folder / "force.csv").string() + " --figure " + (folder / "force.svg").string();
  const ProgramResult result = runHaptolith(bench + " --json");
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json runs = json::parse(result.output).at("runs");
  ASSERT_EQ(runs.size(), 5U) << "an oracle needs no delays";
  EXPECT_EQ(runs[0]["case"], "static");
  EXPECT_EQ(runs[2]["case"], "oracle");
  EXPECT_EQ(runs[4]["case"], "bilateral");
  EXPECT_NEAR(runs[3]["behind_s"].get<double>(), 1.03, 0.05);
  EXPECT_LT(runs[0]["off_in_air_m"].get<double>(), 1e-3);
  std::ifstream csv(folder / "force.csv");
  std::string heading;
  std::getline(csv, heading);
  EXPECT_EQ(heading, "round_trip_s,case,t_s,felt_x_n,felt_y_n,felt_z_n,met_x_n,met_y_n,met_z_n");
  EXPECT_GT(std::filesystem::file_size(folder / "force.svg"), 2000U);
  const ProgramResult again = runHaptolith(bench);
  EXPECT_EQ(again.exit_status, 1) << "before any work";
  EXPECT_THAT(again.errors, HasSubstr("--overwrite"));
  std::filesystem::remove_all(folder);
}

TEST(TeleopCommands, AnOperatorLeadsARobotInAnotherProgram) {
  const std::filesystem::path script =
      std::filesystem::path(testing::TempDir()) / ("haptolith-lead-" + std::to_string(getpid()) + ".py");
  std::ofstream(script) << R"(import json, subprocess, sys
robot = subprocess.Popen([sys.argv[1], 'teleop', 'robot', 'icra2021', '--listen', '127.0.0.1:0', '--duration-s', '20',
                          '--json'], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
port = robot.stderr.readline().split('at port ')[1].split(';')[0].split(',')[0]
lead = subprocess.run([sys.argv[1], 'teleop', 'operator', 'icra2021', '--motion', 'still', '--connect', '127.0.0.1:' + port,
                       '--duration-s', '3', '--json'], capture_output=True, text=True)
robot.send_signal(2)
print(json.dumps({'lead': json.loads(lead.stdout), 'robot': json.loads(robot.communicate()[0])}))
)";
  const ProgramResult result = runInShell("python3 " + script.string() + " \"$HAPTOLITH\"");
  std::filesystem::remove(script);
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json seen = json::parse(result.output);
  EXPECT_EQ(seen["lead"]["robot"]["state"], "following");
  EXPECT_GT(seen["lead"]["robot"]["packets"]["taken"].get<int>(), 50);
  EXPECT_EQ(seen["lead"]["robot"]["packets"]["forged"], 0);
  EXPECT_GT(seen["robot"]["packets"]["taken"].get<int>(), 50);
  EXPECT_EQ(seen["robot"]["packets"]["malformed"], 0);
}

TEST(TeleopCommands, TheOperatorsSoilLearnsAndIsReplayedToTheLastBit) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("haptolith-learns-" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  std::ofstream(folder / "learn.py") << R"(import subprocess, sys
robot = subprocess.Popen([sys.argv[1], 'teleop', 'robot', 'teleop-site', '--set', 'soil.radius_mm=8', '--set', 'soil.stiffness_n_m=3000',
                          '--listen', '127.0.0.1:0', '--duration-s', '40'], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
port = robot.stderr.readline().split('at port ')[1].split(';')[0].split(',')[0]
lead = subprocess.run([sys.argv[1], 'teleop', 'operator', 'teleop-model', '--set', 'soil.radius_mm=9', '--set', 'hand.period_s=24',
                       '--connect', '127.0.0.1:' + port, '--duration-s', '12', '--json', '--record', sys.argv[2]],
                      capture_output=True, text=True)
robot.send_signal(2)
robot.communicate()
print(lead.stdout)
sys.stderr.write(lead.stderr)
)";
  const std::string recording = (folder / "learns.h5").string();
  const ProgramResult result = runInShell("python3 " + (folder / "learn.py").string() + " \"$HAPTOLITH\" " + recording);
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json learned = json::parse(result.output)["robot"]["learned"];
  ASSERT_TRUE(learned.is_object()) << result.output;
  EXPECT_GT(learned["updates"].get<int>(), 0);
  EXPECT_LT(learned["cohesion_pa"]["middle"].get<double>(), 500) << "it began with 545";
  const ProgramResult replayed = runHaptolith("replay " + recording + " --verify --json");
  EXPECT_EQ(replayed.exit_status, 0) << replayed.output << replayed.errors;
  for (const char* format : {"csv", "robot-csv"}) {
    const ProgramResult exported = runHaptolith("export " + recording + " --format " + format);
    EXPECT_EQ(exported.exit_status, 0) << exported.errors;
    EXPECT_THAT(exported.output, HasSubstr("saved"));
  }
  std::ofstream(folder / "both.py") << R"(import csv, json, math, sys
ticks = list(csv.DictReader(open(sys.argv[1])))
reports = list(csv.DictReader(open(sys.argv[2])))
place = lambda row: [float(row['tool_%s_m' % axis]) for axis in 'xyz']
print(json.dumps({'reports': len(reports),
                  'furthest_m': max(math.dist(place(row), place(ticks[int(row['command']) - 1]))
                                    for row in reports if int(row['commands']) > 0),
                  'earliest_s': min(float(row['heard_s']) - 1e-3 * int(row['command']) for row in reports)}))
)";
  const ProgramResult both =
      runInShell("python3 " + (folder / "both.py").string() + " " + (folder / "learns.csv").string() + " " +
                 (folder / "learns-robot.csv").string());
  ASSERT_EQ(both.exit_status, 0) << both.errors;
  const json sides = json::parse(both.output);
  EXPECT_GT(sides["reports"].get<int>(), 300) << "50 a second";
  EXPECT_LT(sides["furthest_m"].get<double>(), 3e-3) << "of the robot's tool from the operator's at the same tick";
  EXPECT_GT(sides["earliest_s"].get<double>(), -1e-9) << "none is heard before its command";
  const std::string without_robot = (folder / "icra2021.h5").string();
  ASSERT_EQ(
      runHaptolith("run icra2021 --no-serve --no-realtime --duration-s 0.05 --record " + without_robot).exit_status, 0);
  const ProgramResult none = runHaptolith("export " + without_robot + " --format robot-csv");
  EXPECT_EQ(none.exit_status, 1);
  EXPECT_THAT(none.errors, HasSubstr("no reports of a robot"));
  std::filesystem::remove_all(folder);

  const ProgramResult refused =
      runHaptolith("teleop operator icra2021 --learn --connect 127.0.0.1:7410 --duration-s 1 --no-serve");
  EXPECT_EQ(refused.exit_status, 2);
  EXPECT_THAT(refused.errors, HasSubstr("contact"));
}

TEST(TeleopCommands, BothEndsStayOnThisMachineWithoutAKey) {
  const ProgramResult robot = runHaptolith("teleop robot icra2021 --listen 0.0.0.0:7410 --duration-s 1");
  EXPECT_EQ(robot.exit_status, 2);
  EXPECT_THAT(robot.errors, AllOf(HasSubstr("0.0.0.0:7410"), HasSubstr("--key-file")));
  const ProgramResult lead =
      runHaptolith("teleop operator icra2021 --connect 192.0.2.1:7410 --duration-s 1 --no-serve");
  EXPECT_EQ(lead.exit_status, 2);
  EXPECT_THAT(lead.errors, AllOf(HasSubstr("192.0.2.1:7410"), HasSubstr("--key-file")));
  EXPECT_THAT(runHaptolith("teleop operator icra2021").errors, HasSubstr("--connect"));
}

TEST(TeleopCommands, AHandThatLetsGoHasNoTaskAndFeelsAModel) {
  for (const char* with : {"--task press", "--case bilateral"}) {
    const ProgramResult result = runHaptolith(std::string("teleop bench --release-s 1 ") + with);
    EXPECT_EQ(result.exit_status, 2) << result.output;
    EXPECT_THAT(result.errors, HasSubstr("--release-s"));
  }
}

TEST(TeleopCommands, WhatIsWrongIsSaid) {
  const auto refused = [](const std::string& arguments) {
    const ProgramResult result = runHaptolith("teleop link " + arguments);
    EXPECT_EQ(result.exit_status, 2) << arguments << result.output;
    return result.errors;
  };
  EXPECT_THAT(refused(""), HasSubstr("--connect or --list is required"));
  EXPECT_THAT(refused("--list --connect 127.0.0.1:9"), HasSubstr("cannot both be given"));
  EXPECT_THAT(refused("--connect here"), HasSubstr("HOST:PORT"));
  EXPECT_THAT(refused("--connect 127.0.0.1:9 --profile mars"), AllOf(HasSubstr("'mars'"), HasSubstr("earth-moon")));
  EXPECT_THAT(refused("--connect 127.0.0.1:9 --loss 2"), HasSubstr("0 to 1"));
  EXPECT_THAT(refused("--connect 127.0.0.1:9 --outage 5,10 --outage 8,1"), HasSubstr("outages"));
  EXPECT_THAT(refused("--connect 127.0.0.1:9 --outage 5,x"), HasSubstr("'5,x' is not valid: must be START_S"));
  EXPECT_THAT(refused("--connect 127.0.0.1:9 --outage 5 --duration-s 1"), HasSubstr("--outage = '5' is not valid"));
  EXPECT_THAT(refused("--connect 127.0.0.1:9 --seed 1.5"), HasSubstr("whole number"));
  EXPECT_THAT(refused("--connect 127.0.0.1:9 --delays-up /nonexistent.csv"), HasSubstr("no such file"));
}

TEST(TeleopCommands, CtrlCEndsABenchWhoseBedsSettle) {
  const ProgramResult result = runInShell(
      "HAPTOLITH_CACHE=off timeout --preserve-status -s INT -k 10 2 \"$HAPTOLITH\" teleop bench --case static "
      "--round-trip-s 0 --threads 1");
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.errors, HasSubstr("interrupted"));
}

}  // namespace
}  // namespace haptolith
