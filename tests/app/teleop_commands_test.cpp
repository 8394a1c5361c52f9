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
  const ProgramResult table = runHaptolith("teleop profiles");
  EXPECT_EQ(table.exit_status, 0);
  EXPECT_THAT(table.output, AllOf(HasSubstr("earth-moon "), HasSubstr("2.6"), HasSubstr("outage")));
  const json profiles = json::parse(runHaptolith("teleop profiles --json").output).at("profiles");
  EXPECT_EQ(profiles.size(), 7U);
  EXPECT_EQ(profiles[0]["name"], "lan");
  EXPECT_NEAR(profiles[5]["loss"].get<double>(), 0.03, 1e-12);
}

TEST(TeleopCommands, ALinkStandsBetweenTwoPrograms) {
  // A robot that answers, an operator that sends 20 packets 10 ms apart and waits for the answers.
  const std::filesystem::path script =
      std::filesystem::path(testing::TempDir()) / ("haptolith-link-" + std::to_string(getpid()) + ".py");
  std::ofstream(script) << R"(import json, socket, subprocess, sys, threading, time
robot = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); robot.bind(('127.0.0.1', 0)); robot.settimeout(5)
link = subprocess.Popen([sys.argv[1], 'teleop', 'link', '--listen', '127.0.0.1:0', '--to', '127.0.0.1:%d' % robot.getsockname()[1],
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

TEST(TeleopCommands, WhatIsWrongIsSaid) {
  const auto refused = [](const std::string& arguments) {
    const ProgramResult result = runHaptolith("teleop link " + arguments);
    EXPECT_EQ(result.exit_status, 2) << arguments << result.output;
    return result.errors;
  };
  EXPECT_THAT(refused(""), HasSubstr("--to"));
  EXPECT_THAT(refused("--to here"), HasSubstr("HOST:PORT"));
  EXPECT_THAT(refused("--to 127.0.0.1:9 --profile mars"), AllOf(HasSubstr("'mars'"), HasSubstr("earth-moon")));
  EXPECT_THAT(refused("--to 127.0.0.1:9 --loss 2"), HasSubstr("0 to 1"));
  EXPECT_THAT(refused("--to 127.0.0.1:9 --outage 5,10 --outage 8,1"), HasSubstr("outages"));
  EXPECT_THAT(refused("--to 127.0.0.1:9 --outage 5,x"), HasSubstr("'x' is not valid"));
  EXPECT_THAT(refused("--to 127.0.0.1:9 --outage 5"), HasSubstr("--outage"));
  EXPECT_THAT(refused("--to 127.0.0.1:9 --seed 1.5"), HasSubstr("whole number"));
  EXPECT_THAT(refused("--to 127.0.0.1:9 --delays-up /nonexistent.csv"), HasSubstr("no such file"));
}

}  // namespace
}  // namespace haptolith
