#include "haptolith/core/platform/udp_socket.h"

#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <span>
#include <string_view>
#include <thread>

#include "haptolith/core/platform/clock.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;
using testing::Optional;

constexpr UdpAddress kHere{0x7F000001, 0};

TEST(UdpAddress, IsReadAndWritten) {
  EXPECT_THAT(udpAddressIn("127.0.0.1:9050"), Optional(UdpAddress{0x7F000001, 9050}));
  EXPECT_THAT(udpAddressIn("localhost:9050"), Optional(UdpAddress{0x7F000001, 9050}));
  EXPECT_THAT(udpAddressIn("0.0.0.0:0"), Optional(UdpAddress{0, 0}));
  EXPECT_THAT(udpAddressIn("255.255.255.255:65535"), Optional(UdpAddress{0xFFFFFFFF, 65535}));
  EXPECT_EQ((UdpAddress{0xC0A80107, 80}.text()), "192.168.1.7:80");
  EXPECT_TRUE((UdpAddress{0x7F123456, 1}.isThisMachine()));
  EXPECT_FALSE((UdpAddress{0, 1}.isThisMachine()));
}

TEST(UdpAddress, NonsenseIsNone) {
  for (const std::string_view text : {"",
                                      ":",
                                      "localhost",
                                      "localhost:",
                                      "127.0.0.1",
                                      "127.0.0.1:",
                                      "127.0.0.1:65536",
                                      "127.0.0.1:-1",
                                      "127.0.0.1:1x",
                                      "127.0.0:1",
                                      "127.0.0.1.1:1",
                                      "256.0.0.1:1",
                                      "127.0.0.01:1",
                                      " 127.0.0.1:1",
                                      "127.0.0.1 :1",
                                      "[::1]:1",
                                      "::1:1",
                                      "example.org:1",
                                      "127..0.1:1",
                                      "0x7f.0.0.1:1"}) {
    EXPECT_FALSE(udpAddressIn(text)) << text;
  }
}

/// The next packet, which may be on its way.
UdpSocket::Received receive(UdpSocket& socket, std::span<std::byte> into, UdpSocket::Packet& packet) {
  UdpSocket::Received received = UdpSocket::Received::kNothing;
  for (int look = 0; look < 2000 && received == UdpSocket::Received::kNothing; ++look) {
    received = socket.receive(into, packet);
    std::this_thread::sleep_for(1ms);
  }
  return received;
}

TEST(UdpSocket, SendsAndReceivesWithoutWaiting) {
  UdpSocket one;
  UdpSocket other;
  ASSERT_EQ(one.open(65536), 0);
  ASSERT_EQ(other.open(65536), 0);
  ASSERT_EQ(one.bind(kHere), 0);
  ASSERT_EQ(other.bind(kHere), 0);
  ASSERT_NE(one.port(), 0);
  std::array<std::byte, 8> into{};
  UdpSocket::Packet packet;
  EXPECT_EQ(other.receive(into, packet), UdpSocket::Received::kNothing);

  const std::array sent{std::byte{1}, std::byte{2}, std::byte{3}};
  const std::int64_t before_ns = wallClockNs();
  ASSERT_TRUE(one.send({kHere.host, other.port()}, sent));
  ASSERT_EQ(receive(other, into, packet), UdpSocket::Received::kPacket);
  EXPECT_EQ(packet.bytes, 3U);
  EXPECT_EQ(into[2], std::byte{3});
  EXPECT_EQ(packet.sender, (UdpAddress{kHere.host, one.port()}));
  if (packet.wall_ns) {
    constexpr std::int64_t kMinute_ns = 60'000'000'000;
    EXPECT_NEAR(static_cast<double>(*packet.wall_ns - before_ns), 0, static_cast<double>(kMinute_ns));
  }
  EXPECT_EQ(other.receive(into, packet), UdpSocket::Received::kNothing);
}

TEST(UdpSocket, APacketThatIsTooLongFillsTheSpace) {
  UdpSocket one;
  UdpSocket other;
  ASSERT_EQ(one.open(65536), 0);
  ASSERT_EQ(other.open(65536), 0);
  ASSERT_EQ(other.bind(kHere), 0);
  const std::array<std::byte, 100> sent{};
  ASSERT_TRUE(one.send({kHere.host, other.port()}, sent));
  std::array<std::byte, 8> into{};
  UdpSocket::Packet packet;
  ASSERT_EQ(receive(other, into, packet), UdpSocket::Received::kPacket);
  EXPECT_EQ(packet.bytes, into.size());
}

TEST(UdpSocket, AReceiverThatIsGoneBreaksNothing) {
  UdpSocket one;
  ASSERT_EQ(one.open(65536), 0);
  ASSERT_EQ(one.bind(kHere), 0);
  std::uint16_t gone = 0;
  {
    UdpSocket other;
    ASSERT_EQ(other.open(65536), 0);
    ASSERT_EQ(other.bind(kHere), 0);
    gone = other.port();
  }
  std::array<std::byte, 8> into{};
  UdpSocket::Packet packet;
  for (int i = 0; i < 5; ++i) {
    (void)one.send({kHere.host, gone}, into);
    std::this_thread::sleep_for(1ms);
    EXPECT_NE(one.receive(into, packet), UdpSocket::Received::kBroken) << UdpSocket::reason(packet.error);
  }
}

TEST(UdpSocket, APortInUseIsSaidToBe) {
  UdpSocket one;
  UdpSocket other;
  ASSERT_EQ(one.open(65536), 0);
  ASSERT_EQ(other.open(65536), 0);
  ASSERT_EQ(one.bind(kHere), 0);
  const int error = other.bind({kHere.host, one.port()});
  ASSERT_NE(error, 0);
  EXPECT_TRUE(UdpSocket::isInUse(error));
  EXPECT_STREQ(UdpSocket::reason(error), "Address already in use");
}

}  // namespace
}  // namespace haptolith
