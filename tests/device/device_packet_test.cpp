#include "haptolith/device/drivers/device_packet.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <limits>
#include <vector>

#include "haptolith/network_device.h"

namespace haptolith {
namespace {

DevicePacket somePacket() {
  DevicePacket packet;
  packet.held = true;
  packet.sequence = 0x01020304;
  packet.buttons = 5;
  packet.sender_time = 0x1122334455667788;
  packet.pose = {Vec3(0.01, -0.02, 0.03), Quat(0.5, -0.5, 0.5, -0.5)};
  packet.twist = {Vec3(1, 2, 3), Vec3(-4, 5, -6)};
  packet.gripper_open = 0.25;
  return packet;
}

/// The bytes of somePacket() with some of them replaced.
template <class T>
auto with(std::size_t offset, T value) {
  auto bytes = bytesOf(somePacket());
  std::memcpy(bytes.data() + offset, &value, sizeof value);
  return bytes;
}

PacketFault faultOf(std::span<const std::byte> bytes) {
  PacketFault fault{};
  EXPECT_FALSE(parse(bytes, &fault));
  EXPECT_FALSE(parse(bytes));
  return fault;
}

TEST(DevicePacket, IsReadAsItWasWritten) {
  const DevicePacket sent = somePacket();
  const auto got = parse(bytesOf(sent));
  ASSERT_TRUE(got);
  EXPECT_EQ(got->held, sent.held);
  EXPECT_EQ(got->sequence, sent.sequence);
  EXPECT_EQ(got->buttons, sent.buttons);
  EXPECT_EQ(got->sender_time, sent.sender_time);
  EXPECT_EQ(got->pose.position_m, sent.pose.position_m);
  EXPECT_EQ(got->pose.orientation.coeffs(), sent.pose.orientation.coeffs());
  EXPECT_EQ(got->twist.linear_m_s, sent.twist.linear_m_s);
  EXPECT_EQ(got->twist.angular_rad_s, sent.twist.angular_rad_s);
  EXPECT_EQ(got->gripper_open, sent.gripper_open);
}

TEST(DevicePacket, LiesInMemoryAsItsTableSays) {
  const auto bytes = bytesOf(somePacket());
  const auto at = [&](std::size_t offset) { return std::to_integer<int>(bytes[offset]); };
  const auto number = [&](std::size_t offset) {
    double value = 0;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
  };
  ASSERT_EQ(bytes.size(), 136U);
  EXPECT_EQ(std::memcmp(bytes.data(), "HLDV\x01\x00\x01\x00\x04\x03\x02\x01\x05\x00\x00\x00", 16), 0);
  EXPECT_EQ(at(16), 0x88);
  EXPECT_EQ(at(23), 0x11);
  EXPECT_EQ(number(24), 0.01);
  EXPECT_EQ(number(40), 0.03);
  EXPECT_EQ(number(48), 0.5) << "w comes first";
  EXPECT_EQ(number(56), -0.5);
  EXPECT_EQ(number(80), 1);
  EXPECT_EQ(number(104), -4);
  EXPECT_EQ(number(128), 0.25);
}

TEST(DevicePacket, OneOfWrongSizeMagicOrVersionIsRefused) {
  const auto whole = bytesOf(somePacket());
  std::vector<std::byte> longer(whole.begin(), whole.end());
  longer.push_back({});
  EXPECT_EQ(faultOf({}), PacketFault::kSize);
  EXPECT_EQ(faultOf(std::span(whole).first(135)), PacketFault::kSize);
  EXPECT_EQ(faultOf(longer), PacketFault::kSize);
  EXPECT_EQ(faultOf(with(0, 'h')), PacketFault::kMagic);
  EXPECT_EQ(faultOf(with(3, 'X')), PacketFault::kMagic);
  EXPECT_EQ(faultOf(with(4, std::uint16_t{0})), PacketFault::kVersion);
  EXPECT_EQ(faultOf(with(4, std::uint16_t{0x0100})), PacketFault::kVersion) << "big-endian";
}

TEST(DevicePacket, NoNumberInItMayBeNanOrInfinite) {
  for (std::size_t offset = 24; offset < DevicePacket::kBytes; offset += 8) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::signaling_NaN(),
                             std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
      EXPECT_EQ(faultOf(with(offset, bad)), PacketFault::kNotFinite) << "byte " << offset;
    }
  }
}

TEST(DevicePacket, ItsQuaternionIsOfUnitLengthWithinOnePerCentAndExactlySoAfterwards) {
  for (const double length : {0.9901, 1.0, 1.0099}) {
    DevicePacket packet = somePacket();
    packet.pose.orientation.coeffs() *= length;
    const auto got = parse(bytesOf(packet));
    ASSERT_TRUE(got) << length;
    EXPECT_NEAR(got->pose.orientation.norm(), 1, 1e-15);
  }
  for (const double length : {0.0, 1e-200, 0.9899, 1.0101, 1e200, -2.0}) {  // 1e200: its square overflows
    DevicePacket packet = somePacket();
    packet.pose.orientation.coeffs() *= length;
    EXPECT_EQ(faultOf(bytesOf(packet)), PacketFault::kNotUnit) << length;
  }
}

TEST(DevicePacket, ItsValuesAreThoseOfAnArm) {
  const struct {
    std::size_t first, last;
    double largest;
  } ranges[] = {{24, 40, 10}, {80, 96, 100}, {104, 120, 1000}};
  for (const auto& [first, last, largest] : ranges) {
    for (std::size_t offset = first; offset <= last; offset += 8) {
      for (const double sign : {-1.0, 1.0}) {
        EXPECT_TRUE(parse(with(offset, sign * largest))) << offset;
        EXPECT_EQ(faultOf(with(offset, sign * largest * 1.0001)), PacketFault::kRange) << offset;
      }
    }
  }
  EXPECT_TRUE(parse(with(128, 1.0)));
  EXPECT_EQ(faultOf(with(128, 1.0001)), PacketFault::kRange);
  EXPECT_EQ(faultOf(with(128, -0.0001)), PacketFault::kRange);
}

TEST(DevicePacket, FlagsOfLaterVersionsAreIgnored) {
  EXPECT_TRUE(parse(with(6, std::uint16_t{0xffff}))->held);
  EXPECT_FALSE(parse(with(6, std::uint16_t{0xfffe}))->held);
}

TEST(AnswerPacket, IsReadAsItWasWritten) {
  AnswerPacket sent;
  sent.let_go = true;
  sent.sequence = 7;
  sent.number = 8;
  sent.sender_time = 9;
  sent.output = {{Vec3(1, -2, 3), Vec3(-0.1, 0.2, 0.3)}, -4};
  auto bytes = bytesOf(sent);
  ASSERT_EQ(bytes.size(), 80U);
  const auto got = parseAnswer(bytes);
  ASSERT_TRUE(got);
  EXPECT_FALSE(got->live);
  EXPECT_TRUE(got->let_go);
  EXPECT_EQ(got->sequence, 7U);
  EXPECT_EQ(got->number, 8U);
  EXPECT_EQ(got->sender_time, 9U);
  EXPECT_EQ(got->output.wrench.force_n, sent.output.wrench.force_n);
  EXPECT_EQ(got->output.wrench.torque_nm, sent.output.wrench.torque_nm);
  EXPECT_EQ(got->output.gripper_force_n, -4);

  EXPECT_FALSE(parseAnswer(std::span(bytes).first(79)));
  bytes[4] = std::byte{2};
  EXPECT_FALSE(parseAnswer(bytes)) << "version 2";
  sent.output.wrench.torque_nm.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(parseAnswer(bytesOf(sent)));
}

template <class T>
void expectTheBytesOf(const T& structure, std::span<const std::byte> bytes) {
  ASSERT_EQ(bytes.size(), sizeof structure);
  EXPECT_EQ(std::memcmp(&structure, bytes.data(), sizeof structure), 0);
}

TEST(NetworkDeviceHeader, DescribesThePacketsForC) {
  static_assert(sizeof(hapto_network_packet) == DevicePacket::kBytes);
  static_assert(sizeof(hapto_network_answer) == AnswerPacket::kBytes);
  static_assert(HAPTO_NETWORK_VERSION == DevicePacket::kVersion && HAPTO_NETWORK_VERSION == AnswerPacket::kVersion);

  hapto_network_packet packet{.magic = {},
                              .version = HAPTO_NETWORK_VERSION,
                              .flags = HAPTO_NETWORK_HELD,
                              .sequence = 0x01020304,
                              .buttons = 5,
                              .sender_time = 0x1122334455667788,
                              .position_m = {0.01, -0.02, 0.03},
                              .orientation_wxyz = {0.5, -0.5, 0.5, -0.5},
                              .velocity_m_s = {1, 2, 3},
                              .angular_velocity_rad_s = {-4, 5, -6},
                              .gripper_open = 0.25};
  std::memcpy(packet.magic, HAPTO_NETWORK_PACKET_MAGIC, sizeof packet.magic);
  expectTheBytesOf(packet, bytesOf(somePacket()));

  hapto_network_answer answer{.magic = {},
                              .version = HAPTO_NETWORK_VERSION,
                              .flags = HAPTO_NETWORK_LIVE,
                              .sequence = 7,
                              .number = 8,
                              .sender_time = 9,
                              .force_n = {1, -2, 3},
                              .torque_nm = {-0.1, 0.2, 0.3},
                              .gripper_force_n = -4};
  std::memcpy(answer.magic, HAPTO_NETWORK_ANSWER_MAGIC, sizeof answer.magic);
  AnswerPacket told;
  told.live = true;
  told.sequence = 7;
  told.number = 8;
  told.sender_time = 9;
  told.output = {{Vec3(1, -2, 3), Vec3(-0.1, 0.2, 0.3)}, -4};
  expectTheBytesOf(answer, bytesOf(told));
  told.live = false;
  told.let_go = true;
  answer.flags = HAPTO_NETWORK_LET_GO;
  expectTheBytesOf(answer, bytesOf(told));
}

}  // namespace
}  // namespace haptolith
