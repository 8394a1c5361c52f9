#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/child_process.h"
#include "haptolith/teleop/link/packet_seal.h"
#include "haptolith/teleop/operator/operator_end.h"
#include "haptolith/teleop/robot/robot_server.h"

#include "../source_dir.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const std::string kKey(64, 'a');
const std::string kOtherKey(64, 'b');
constexpr double kTick_s = 1e-3;

TEST(PacketSeal, ProvesWhoSentAPacketOnceBothHaveSpoken) {
  PacketSeal one(kKey), other(kKey);
  const Packet packet{1, 2, 3};
  const Packet greeting = one.seal(packet);
  EXPECT_EQ(greeting.size(), packet.size() + PacketSeal::kBytes);
  const PacketSeal::Opened greeted = other.open(greeting);
  EXPECT_EQ(greeted.proof, PacketSeal::Proof::kGreeting);
  const Packet answer = other.seal({4, 5});
  const PacketSeal::Opened opened = one.open(answer);
  EXPECT_EQ(opened.proof, PacketSeal::Proof::kFresh);
  EXPECT_EQ(Packet(opened.packet.begin(), opened.packet.end()), (Packet{4, 5}));
  EXPECT_EQ(other.open(one.seal(packet)).proof, PacketSeal::Proof::kFresh);
}

TEST(PacketSeal, ForgedIsWhatHasAnotherKeyAByteChangedOrIsOfAnotherRun) {
  PacketSeal one(kKey), other(kKey), stranger(kOtherKey);
  (void)other.open(one.seal({1}));
  (void)one.open(other.seal({1}));
  const Packet good = one.seal({1, 2, 3});
  for (std::size_t i = 0; i < good.size(); ++i) {
    Packet changed = good;
    changed[i] ^= 1U;
    EXPECT_EQ(other.open(changed).proof, PacketSeal::Proof::kForged) << i;
  }
  EXPECT_EQ(other.open(stranger.seal({1})).proof, PacketSeal::Proof::kForged);
  EXPECT_EQ(other.open({}).proof, PacketSeal::Proof::kForged);
  PacketSeal later(kKey);  // this end, restarted
  EXPECT_EQ(later.open(good).proof, PacketSeal::Proof::kForged) << "of the run before";
  EXPECT_EQ(other.open(good).proof, PacketSeal::Proof::kFresh);
}

TEST(PacketSeal, WithoutAKeyAddsNothing) {
  PacketSeal none("");
  EXPECT_EQ(none.seal({1, 2}), (Packet{1, 2}));
  EXPECT_EQ(none.open(Packet{7}).proof, PacketSeal::Proof::kFresh);
  EXPECT_THROW(PacketSeal("not a key"), InvalidParameter);
}

/// A robot and its sender, over real sockets of this machine.
class Ends : public testing::Test {
 protected:
  void begin(const std::string& key) {
    EndOptions options;
    options.listen = "127.0.0.1:0";
    options.key = key;
    server_.emplace(robot_, options, kTick_s);
    to_ = "127.0.0.1:" + std::to_string(server_->port());
  }

  /// Lets both ends run, a tick at a time, until something is so or two seconds have passed.
  template <class Wanted>
  bool until(Wanted&& wanted, OperatorEnd* end) {
    for (int i = 0; i < 2000; ++i) {
      if (end != nullptr) {
        end->follow(std::span(&tick_, 1));
      }
      server_->receive();
      robot_.tick();
      server_->answer();
      if (end != nullptr) {
        end->receive();
      }
      if (wanted()) {
        return true;
      }
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    return false;
  }

  static TickRecord still() {
    TickRecord tick;
    tick.scene_T_tool.position_m = {0, 0, 0.1};
    tick.rendered.wrench.force_n = {1, 0, 0};
    return tick;
  }
  static Packet commandOf(std::uint32_t connection, std::uint64_t number) {
    CommandPacket packet;
    packet.connection = connection;
    packet.number = number;
    packet.keyframes.resize(1);
    packet.keyframes[0].index = number;
    return bytesOf(packet);
  }

  Scene scene_{BedParameters(), ToolParameters()};
  Robot robot_{RobotParameters(), scene_, 0, {{0, 0, 0.1}, Quat::Identity()}};
  std::optional<RobotServer> server_;
  std::string to_;
  TickRecord tick_ = still();
};

TEST_F(Ends, FindEachOtherAndAgreeOnCommands) {
  for (const std::string& key : {std::string(), kKey}) {
    begin(key);
    EndOptions options;
    options.key = key;
    OperatorEnd end(to_, options, 0, kTick_s);
    EXPECT_TRUE(until([&] { return end.news().heard && robot_.state() == RobotState::kFollowing; }, &end));
    EXPECT_TRUE(until([&] { return !end.agreement().windows().empty(); }, &end));
    EXPECT_NEAR(end.agreement().windows()[0].displayed_n.x(), 1, 1e-12);
    EXPECT_LT(end.news().round_trip_s, 0.5);
    EXPECT_EQ(end.counts().forged, 0U);
    EXPECT_EQ(server_->counts().forged, 0U);
  }
}

TEST_F(Ends, WhatTheRobotSeesComesToItsOperatorAlone) {
  for (const std::string& key : {std::string(), kKey}) {
    begin(key);
    EndOptions options;
    options.key = key;
    OperatorEnd end(to_, options, 0, kTick_s);
    SitePacket seen;
    seen.grid = {0, 0, 0.01, 2, 1};
    seen.columns = 2;
    seen.rows = 1;
    seen.steps = {10, -10};
    server_->show(seen);  // no receiver yet
    ASSERT_TRUE(until([&] { return end.news().heard; }, &end));
    EXPECT_TRUE(end.site().empty());
    seen.index = 1000000;  // by the commands of an earlier operator
    const std::uint64_t before = end.counts().replayed;
    EXPECT_TRUE(until(
        [&] {
          ++seen.number;
          server_->show(seen);
          return end.counts().replayed > before;
        },
        &end));
    EXPECT_TRUE(end.site().empty());
    seen.index = 0;
    EXPECT_TRUE(until(
        [&] {
          ++seen.number;
          server_->show(seen);
          return !end.site().empty();
        },
        &end));
    EXPECT_DOUBLE_EQ(end.site().heights()[1], -0.001);
    EXPECT_EQ(end.counts().malformed, 0U);
  }
}

TEST_F(Ends, AStrangerWithoutTheKeyMovesNothing) {
  begin(kKey);
  EndOptions options;
  options.key = kOtherKey;
  OperatorEnd stranger(to_, options, 0, kTick_s);
  EXPECT_FALSE(until([&] { return robot_.connection() != 0; }, &stranger));
  EXPECT_GT(server_->counts().forged, 0U);
  EXPECT_FALSE(stranger.news().ever);
  UdpPort port("connect", "127.0.0.1:0");
  port.send(to_, commandOf(5, 1));  // unsigned
  EXPECT_TRUE(until([&] { return server_->counts().forged > 10 || robot_.connection() != 0; }, &stranger));
  EXPECT_EQ(robot_.connection(), 0U);
}

TEST_F(Ends, WhatHasBeenListenedToIsOfNoUse) {
  begin(kKey);
  PacketSeal friendly(kKey);
  UdpPort port("connect", "127.0.0.1:0");
  const auto answer = [&] {
    std::optional<UdpPort::Datagram> datagram;
    EXPECT_TRUE(until([&] { return (datagram = port.receive()).has_value(); }, nullptr));
    return datagram ? datagram->bytes : Packet();
  };
  const Packet greeting = friendly.seal(commandOf(5, 1));
  port.send(to_, greeting);
  ASSERT_EQ(friendly.open(answer()).proof, PacketSeal::Proof::kFresh);
  EXPECT_EQ(robot_.connection(), 0U) << "a greeting commands nothing";
  const Packet kept = friendly.seal(commandOf(5, 2));
  port.send(to_, kept);
  ASSERT_TRUE(until([&] { return server_->counts().taken == 1; }, nullptr));
  UdpPort thief("connect", "127.0.0.1:0");
  thief.send(to_, kept);
  ASSERT_TRUE(until([&] { return server_->counts().replayed == 1; }, nullptr)) << "in the same connection";
  port.send(to_, friendly.seal(commandOf(6, 1)));
  ASSERT_TRUE(until([&] { return server_->counts().taken == 2; }, nullptr)) << "the operator began anew";
  thief.send(to_, kept);
  ASSERT_TRUE(until([&] { return server_->counts().replayed == 2; }, nullptr)) << "of a connection that is over";
  EXPECT_EQ(robot_.connection(), 6U);
}

TEST_F(Ends, ARobotThatIsStartedAgainIsLedAgain) {
  for (const std::string& key : {std::string(), kKey}) {
    begin(key);
    EndOptions options;
    options.key = key;
    OperatorEnd end(to_, options, 0, kTick_s);
    ASSERT_TRUE(until([&] { return end.news().heard && server_->counts().taken > 0; }, &end));
    const std::uint32_t before = end.news().state.robot_connection;
    options.listen = to_;
    server_.reset();
    server_.emplace(robot_, options, kTick_s);
    const auto enough = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (server_->counts().taken == 0 && std::chrono::steady_clock::now() < enough) {
      (void)until([&] { return server_->counts().taken > 0; }, &end);
    }
    EXPECT_GT(server_->counts().taken, 0U);
    EXPECT_TRUE(until([&] { return end.news().state.robot_connection != before; }, &end));
  }
}

TEST_F(Ends, WithoutAKeyTheFirstIsHeardUntilItFallsSilent) {
  begin("");
  UdpPort first("connect", "127.0.0.1:0"), second("connect", "127.0.0.1:0");
  first.send(to_, commandOf(5, 1));
  ASSERT_TRUE(until([&] { return server_->counts().taken == 1; }, nullptr));
  second.send(to_, commandOf(6, 1));
  ASSERT_TRUE(until([&] { return server_->counts().strangers == 1; }, nullptr));
  EXPECT_EQ(robot_.connection(), 5U);
  for (int tick = 0; tick < 3100; ++tick) {
    server_->answer();
  }
  second.send(to_, commandOf(6, 2));
  ASSERT_TRUE(until([&] { return server_->counts().taken == 2; }, nullptr));
  EXPECT_EQ(robot_.connection(), 6U);
}

TEST_F(Ends, RubbishIsCountedAndDropped) {
  begin("");
  UdpPort port("connect", "127.0.0.1:0");
  for (const std::size_t size : {0U, 1U, 31U, 96U, 2000U}) {
    port.send(to_, Packet(size, 0x48));
  }
  EXPECT_TRUE(until([&] { return server_->counts().malformed == 5; }, nullptr));
  EXPECT_EQ(server_->counts().first_malformed, "an empty packet");
  EXPECT_EQ(server_->counts().taken, 0U);
}

TEST(MalformedPackets, AreDescribed) {
  const auto bytes_of = [](std::string_view text) { return Packet(text.begin(), text.end()); };
  EXPECT_EQ(describeMalformedCommand(bytes_of("move 0.1 0 0\n")), "13 bytes of text, 'move 0.1 0 0.'");
  EXPECT_THAT(describeMalformedCommand(bytes_of(std::string("HLTC\0\1", 6) + std::string(90, '\0'))),
              HasSubstr("little-endian"));
  EXPECT_THAT(describeMalformedCommand(bytes_of(std::string("HLTC\1\0", 6) + std::string(90, '\0'))),
              HasSubstr("truncated"));
  EXPECT_THAT(describeMalformedCommand(bytes_of(std::string("HLTS\1\0", 6) + std::string(90, '\0'))),
              HasSubstr("begin with 'HLTS' instead of HLTC"));
  EXPECT_THAT(describeMalformedReport(bytes_of(std::string("HLTM\2\0", 6) + std::string(90, '\0'))),
              HasSubstr("version 2"));
}

TEST_F(Ends, NobodyListensBeyondThisMachineWithoutAKey) {
  EndOptions options;
  options.listen = "0.0.0.0:0";
  EXPECT_THAT([&] { RobotServer(robot_, options, kTick_s); }, ThrowsMessage<InvalidParameter>(HasSubstr("--key-file")));
  EXPECT_THAT([&] { OperatorEnd("192.0.2.1:7410", EndOptions(), 0, kTick_s); },
              ThrowsMessage<InvalidParameter>(HasSubstr("192.0.2.1")));
  options.insecure = true;
  EXPECT_NO_THROW(RobotServer(robot_, options, kTick_s));
  options.insecure = false;
  options.key = kKey;
  EXPECT_NO_THROW(RobotServer(robot_, options, kTick_s));
  EXPECT_THROW(OperatorEnd("nowhere", options, 0, kTick_s), InvalidParameter);
}

class PythonsRobot : public testing::TestWithParam<bool> {};

TEST_P(PythonsRobot, FollowsAnOperatorAndTellsTheForceOfItsGround) {
  if (std::system("python3 --version > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "no python3";
  }
  const std::filesystem::path key_file =
      std::filesystem::temp_directory_path() / ("haptolith-teleop-" + std::to_string(getpid()) + ".key");
  std::ofstream(key_file) << kKey << '\n';
  std::string to;
  {
    UdpPort free("connect", "127.0.0.1:0");
    to = "127.0.0.1:" + std::to_string(free.port());
  }
  std::vector<std::string> arguments{
      "python3", (sourceDir() / "examples/teleop_robot.py").string(), "--listen", to, "--seconds", "30"};
  EndOptions options;
  if (GetParam()) {
    options.key = kKey;
    arguments.emplace_back("--key-file");
    arguments.push_back(key_file.string());
  }
  ChildProcess robot({.arguments = arguments, .package = "python3", .environment = {}}, {});
  OperatorEnd end(to, options, 0, kTick_s);
  TickRecord tick;
  tick.rendered.wrench.force_n = {0, 0, 5};
  tick.scene_T_tool.position_m = {0.02, 0, -0.01};  // 10 mm deep
  const auto enough = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (end.agreement().windows().size() < 3 && std::chrono::steady_clock::now() < enough) {
    end.follow(std::span(&tick, 1));
    end.receive();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(end.news().state.state, RobotState::kFollowing);
  ASSERT_GE(end.agreement().windows().size(), 3U);
  EXPECT_NEAR(end.agreement().windows()[1].met_n.z(), 5, 1e-3) << "500 N/m";
  EXPECT_NEAR(end.agreement().share(0, 100), 0, 1e-3);
  EXPECT_NEAR(end.news().state.reports.back().pose.position_m.x(), 0.02, 1e-6);
  ASSERT_EQ(end.site().heights().size(), 256U);
  EXPECT_EQ(end.site().heights()[0], 0);
  EXPECT_NEAR(end.site().heights()[8 * 16 + 9], -0.01, 1e-9) << "it gives way under the tool";
  EXPECT_EQ(end.counts().malformed, 0U);
  EXPECT_EQ(end.counts().forged, 0U);
  std::filesystem::remove(key_file);
}

INSTANTIATE_TEST_SUITE_P(All, PythonsRobot, testing::Bool(), [](const testing::TestParamInfo<bool>& test) {
  return std::string(test.param ? "WithAKey" : "WithoutAKey");
});

}  // namespace
}  // namespace haptolith
