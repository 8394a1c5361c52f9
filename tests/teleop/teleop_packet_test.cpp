#include "haptolith/teleop/link/teleop_packet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/teleop.h"

namespace haptolith {
namespace {

CommandPacket someCommand(std::size_t keyframes) {
  CommandPacket packet;
  packet.tare = true;
  packet.connection = 7;
  packet.number = 123456789012;
  packet.sender_time = 42;
  for (std::size_t i = 0; i < keyframes; ++i) {
    Keyframe key;
    key.index = 1000 + 20 * i;
    key.hand.pose.position_m = {0.1 + 0.01 * static_cast<double>(i), -0.2, 0.3};
    key.hand.pose.orientation = Eigen::AngleAxisd(0.5, Vec3(1, 2, 2) / 3);
    key.hand.twist = {{0.1, 0.2, -0.3}, {1, -2, 3}};
    key.hand.opening = 0.25;
    packet.keyframes.push_back(key);
  }
  return packet;
}

StatePacket someState(std::size_t reports) {
  StatePacket packet;
  packet.at_force_cap = packet.at_edge = true;
  packet.operator_connection = 7;
  packet.robot_connection = 9;
  packet.number = 5;
  packet.sender_time = 42;
  packet.newest = 1100;
  packet.state = RobotState::kHolding;
  packet.reason = StopReason::kForce;
  for (std::size_t i = 0; i < reports; ++i) {
    RobotReport report;
    report.index = 1000 + 20 * i;
    report.ticks = 20;
    report.pose.position_m = {0.1, 0.2, -0.3};
    report.met = {{1, -2, 3}, {0.1, 0.2, 0.3}};
    packet.reports.push_back(report);
  }
  return packet;
}

template <class T>
void put(Packet& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

TEST(CommandPacket, ComesOutAsItWentIn) {
  const CommandPacket sent = someCommand(7);
  const Packet bytes = bytesOf(sent);
  EXPECT_EQ(bytes.size(), 32 + 7 * 64U);
  const auto read = parseCommand(bytes);
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->held);
  EXPECT_TRUE(read->tare);
  EXPECT_EQ(read->connection, 7U);
  EXPECT_EQ(read->number, sent.number);
  EXPECT_EQ(read->sender_time, 42U);
  ASSERT_EQ(read->keyframes.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) {
    const HandState& was = sent.keyframes[i].hand;
    const HandState& is = read->keyframes[i].hand;
    EXPECT_EQ(read->keyframes[i].index, sent.keyframes[i].index);
    EXPECT_LT((is.pose.position_m - was.pose.position_m).norm(), 5e-8) << "half a micrometre at 10 m";
    EXPECT_LT(is.pose.orientation.angularDistance(was.pose.orientation), 1e-6);
    EXPECT_LT((is.twist.linear_m_s - was.twist.linear_m_s).norm(), 1e-7);
    EXPECT_LT((is.twist.angular_rad_s - was.twist.angular_rad_s).norm(), 1e-6);
    EXPECT_EQ(is.opening, 0.25);
  }
}

TEST(CommandPacket, HasItsValuesWhereItSays) {
  Packet bytes = bytesOf(someCommand(1));
  EXPECT_EQ(std::memcmp(bytes.data(), "HLTC", 4), 0);
  EXPECT_EQ(bytes[4], 1) << "version";
  EXPECT_EQ(bytes[6], 3) << "held, tare";
  EXPECT_EQ(bytes[8], 7) << "connection";
  EXPECT_EQ(bytes[12], 1) << "one key";
  put(bytes, 32, std::uint64_t{77});
  put(bytes, 32 + 16, 0.75F);
  put(bytes, 32 + 60, 1.0F);
  const auto read = parseCommand(bytes);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->keyframes[0].index, 77U);
  EXPECT_EQ(read->keyframes[0].hand.pose.position_m.z(), 0.75);
  EXPECT_EQ(read->keyframes[0].hand.opening, 1);
}

TEST(CommandPacket, WhatIsMalformedIsNotTaken) {
  const Packet good = bytesOf(someCommand(2));
  ASSERT_TRUE(parseCommand(good));
  const auto refused = [&](const char* what, std::size_t at, auto value) {
    Packet bytes = good;
    put(bytes, at, value);
    EXPECT_FALSE(parseCommand(bytes)) << what;
  };
  refused("magic", 0, 'X');
  refused("version", 4, std::uint16_t{2});
  refused("no connection", 8, std::uint32_t{0});
  refused("no keyframes", 12, std::uint32_t{0});
  refused("fewer keyframes than there are", 12, std::uint32_t{1});
  refused("more keyframes than there are", 12, std::uint32_t{3});
  refused("countless keyframes", 12, std::numeric_limits<std::uint32_t>::max());
  refused("keyframes that do not grow", 32 + 64, std::uint64_t{1000});
  refused("NaN", 32 + 8, std::numeric_limits<float>::quiet_NaN());
  refused("infinity", 32 + 12, std::numeric_limits<float>::infinity());
  refused("beyond 10 m", 32 + 8, 10.5F);
  refused("no unit turn", 32 + 20, 5.0F);
  refused("faster than 100 m/s", 32 + 36, -101.0F);
  refused("turning faster than 1000 rad/s", 32 + 48, 1001.0F);
  refused("NaN opening", 32 + 60, std::numeric_limits<float>::quiet_NaN());
  refused("more than wide open", 32 + 60, 1.5F);
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(parseCommand(std::span(good).first(size))) << size;
  }
  Packet longer = good;
  longer.push_back(0);
  EXPECT_FALSE(parseCommand(longer));
}

TEST(StatePacket, ComesOutAsItWentIn) {
  const StatePacket sent = someState(4);
  const Packet bytes = bytesOf(sent);
  EXPECT_EQ(bytes.size(), 48 + 4 * 72U);
  const auto read = parseState(bytes);
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->at_force_cap);
  EXPECT_FALSE(read->at_speed_cap);
  EXPECT_TRUE(read->at_edge);
  EXPECT_EQ(read->operator_connection, 7U);
  EXPECT_EQ(read->robot_connection, 9U);
  EXPECT_EQ(read->newest, 1100U);
  EXPECT_EQ(read->state, RobotState::kHolding);
  EXPECT_EQ(read->reason, StopReason::kForce);
  ASSERT_EQ(read->reports.size(), 4U);
  EXPECT_EQ(read->reports[3].index, 1060U);
  EXPECT_EQ(read->reports[3].ticks, 20U);
  EXPECT_EQ(read->reports[3].met.force_n, Vec3(1, -2, 3));
}

TEST(StatePacket, WhatIsMalformedIsNotTaken) {
  const Packet good = bytesOf(someState(2));
  ASSERT_TRUE(parseState(good));
  const auto refused = [&](const char* what, std::size_t at, auto value) {
    Packet bytes = good;
    put(bytes, at, value);
    EXPECT_FALSE(parseState(bytes)) << what;
  };
  refused("magic", 3, 'C');
  refused("no connection of its own", 12, std::uint32_t{0});
  refused("state", 40, std::uint8_t{7});
  refused("reason", 41, std::uint8_t{8});
  refused("count", 42, std::uint16_t{65535});
  refused("a mean over more than there was", 48 + 8, std::uint32_t{2000});
  refused("NaN force", 48 + 44, std::numeric_limits<float>::quiet_NaN());
  refused("reports that do not grow", 48 + 72, std::uint64_t{999});
}

TEST(TeleopPackets, RandomBytesAreNone) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 20000; ++i) {
    Packet bytes = i % 2 == 0 ? bytesOf(someCommand(1 + random() % 3)) : bytesOf(someState(1 + random() % 3));
    for (std::uint64_t flips = 1 + random() % 4; flips > 0; --flips) {
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    }
    if (const auto command = parseCommand(bytes)) {
      for (const Keyframe& key : command->keyframes) {
        EXPECT_TRUE(key.hand.pose.position_m.allFinite());
        EXPECT_NEAR(key.hand.pose.orientation.norm(), 1, 1e-9);
      }
    }
    (void)parseState(bytes);
  }
}

TEST(TeleopPackets, HoldAtMostWhatTheySay) {
  EXPECT_THROW((void)bytesOf(someCommand(0)), InvalidParameter);
  EXPECT_THROW((void)bytesOf(someCommand(65)), InvalidParameter);
  EXPECT_THROW((void)bytesOf(someState(65)), InvalidParameter);
  EXPECT_TRUE(parseCommand(bytesOf(someCommand(64))));
}

TEST(TeleopHeader, DescribesThePacketsForC) {
  static_assert(sizeof(hapto_teleop_command_header) == CommandPacket::kHeaderBytes);
  static_assert(sizeof(hapto_teleop_command_key) == CommandPacket::kKeyframeBytes);
  static_assert(sizeof(hapto_teleop_state_header) == StatePacket::kHeaderBytes);
  static_assert(sizeof(hapto_teleop_robot_report) == StatePacket::kReportBytes);
  static_assert(HAPTO_TELEOP_MOST_KEYS == CommandPacket::kMostKeyframes &&
                HAPTO_TELEOP_MOST_KEYS == StatePacket::kMostReports);
  static_assert(HAPTO_ROBOT_FAILED == static_cast<int>(RobotState::kFailed) &&
                HAPTO_ROBOT_FOLLOWING == static_cast<int>(RobotState::kFollowing) &&
                HAPTO_STOP_FAULT == static_cast<int>(StopReason::kFault) &&
                HAPTO_STOP_GAP == static_cast<int>(StopReason::kGap));
  const Packet command = bytesOf(someCommand(2));
  hapto_teleop_command_header header;
  hapto_teleop_command_key key;
  std::memcpy(&header, command.data(), sizeof header);
  std::memcpy(&key, command.data() + sizeof header + sizeof key, sizeof key);
  EXPECT_EQ(header.flags, HAPTO_TELEOP_HELD | HAPTO_TELEOP_TARE);
  EXPECT_EQ(header.keys, 2U);
  EXPECT_EQ(header.number, 123456789012U);
  EXPECT_EQ(key.index, 1020U);
  EXPECT_EQ(key.position_m[2], 0.3F);
  EXPECT_EQ(key.angular_velocity_rad_s[1], -2.0F);
  EXPECT_EQ(key.opening, 0.25F);
  const Packet state = bytesOf(someState(1));
  hapto_teleop_state_header told;
  hapto_teleop_robot_report report;
  std::memcpy(&told, state.data(), sizeof told);
  std::memcpy(&report, state.data() + sizeof told, sizeof report);
  EXPECT_EQ(told.flags, HAPTO_TELEOP_AT_FORCE_CAP | HAPTO_TELEOP_AT_EDGE);
  EXPECT_EQ(told.state, HAPTO_ROBOT_HOLDING);
  EXPECT_EQ(told.reason, HAPTO_STOP_FORCE);
  EXPECT_EQ(report.ticks, 20U);
  EXPECT_EQ(report.force_n[1], -2.0F);
  EXPECT_EQ(report.torque_nm[2], 0.3F);
}

TEST(KeyframeHistory, SendsWhatMayHaveBeenLostAgain) {
  KeyframeHistory<int> movement({8, 4, 2, 1, 0});
  KeyframeHistory<int> forces(reportLags(3));
  std::vector<int> sent, told;
  for (int i = 0; i <= 20; ++i) {
    sent = movement.add(i);
    told = forces.add(i);
    if (i == 1) {
      EXPECT_EQ(sent, (std::vector<int>{0, 1})) << "there is no more yet";
    }
  }
  EXPECT_EQ(sent, (std::vector<int>{12, 16, 18, 19, 20}));
  EXPECT_EQ(told, (std::vector<int>{18, 19, 20}));
}

TEST(CommandLags, DoubleUntilAHandIsNoLongerSmooth) {
  EXPECT_EQ(commandLags(0.02, 13), (std::vector<std::size_t>{121, 106, 91, 76, 61, 46, 31, 16, 8, 4, 2, 1, 0}));
  EXPECT_EQ(commandLags(0.1, 6), (std::vector<std::size_t>{10, 7, 4, 2, 1, 0}));
  EXPECT_EQ(commandLags(1, 3), (std::vector<std::size_t>{2, 1, 0}));
}

TEST(SendingOver, FillsNoMoreThanFourFifthsOfALink) {
  for (const double rate_bit_s : {0.0, 64e3, 128e3, 256e3, 1e6, 1e7}) {
    LinkParameters way;
    way.rate_bit_s = rate_bit_s;
    const Sending sending = sendingOver(way, way);
    const double up_bytes = 28 + 32 + 64.0 * static_cast<double>(sending.command_keyframes);
    const double down_bytes = 28 + 48 + 72.0 * static_cast<double>(sending.report_keys);
    if (rate_bit_s > 0) {
      EXPECT_LE(8 * up_bytes / sending.period_s, 0.8 * rate_bit_s) << rate_bit_s;
      EXPECT_LE(8 * down_bytes / sending.period_s, 0.8 * rate_bit_s) << rate_bit_s;
    }
    const auto furthest = static_cast<double>(commandLags(sending.period_s, sending.command_keyframes).front());
    EXPECT_GE(furthest * sending.period_s, 0.3) << rate_bit_s;
  }
  EXPECT_EQ(sendingOver({}, {}).command_keyframes, 13U);
}

}  // namespace
}  // namespace haptolith
