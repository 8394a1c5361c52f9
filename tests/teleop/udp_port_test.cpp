#include "haptolith/teleop/link/udp_port.h"

#include <gmock/gmock.h>

#include <chrono>
#include <string>
#include <thread>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::optional<UdpPort::Datagram> received(UdpPort& port) {
  using Clock = std::chrono::steady_clock;
  for (const auto end = Clock::now() + std::chrono::seconds(5); Clock::now() < end;
       std::this_thread::sleep_for(std::chrono::microseconds(200))) {
    if (auto datagram = port.receive()) {
      return datagram;
    }
  }
  return std::nullopt;
}

std::string addressOf(const UdpPort& port) {
  return "127.0.0.1:" + std::to_string(port.port());
}

TEST(UdpPort, ExchangesDatagramsWithTheAddressOfTheirSender) {
  UdpPort one("one", "localhost:0"), other("other", "127.0.0.1:0");
  EXPECT_FALSE(one.receive()) << "it does not wait";
  one.send(addressOf(other), {1, 2, 3});
  const auto there = received(other);
  ASSERT_TRUE(there);
  EXPECT_EQ(there->bytes, (Packet{1, 2, 3}));
  EXPECT_EQ(there->from, addressOf(one));
  other.send(there->from, {});
  const auto back = received(one);
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->bytes.empty());
}

TEST(UdpPort, GoesOnWhenNothingListensThere) {
  UdpPort one("one", "127.0.0.1:0"), other("other", "127.0.0.1:0");
  std::string gone;
  {
    const UdpPort closed("closed", "127.0.0.1:0");
    gone = addressOf(closed);
  }
  one.send(gone, {1});
  one.send("[::1]:9", {1});  // another protocol
  EXPECT_FALSE(one.receive());
  other.send(addressOf(one), {2});
  EXPECT_TRUE(received(one));
}

TEST(UdpPort, RefusesAddressesThatAreNone) {
  for (const char* wrong : {"", "7400", "127.0.0.1", "127.0.0.1:", "127.0.0.1:x", "127.0.0.1:70000", "127.0.0.1:7 ",
                            "example.org:7400", "[::1:7400", ":7400"}) {
    EXPECT_THAT([&] { const UdpPort port("--listen", wrong); }, ThrowsMessage<InvalidParameter>(HasSubstr("--listen")))
        << wrong;
  }
  UdpPort port("one", "127.0.0.1:0");
  EXPECT_THROW(port.send("nowhere", {1}), InvalidParameter);
  EXPECT_THAT([&] { const UdpPort second("--listen", addressOf(port)); },
              ThrowsMessage<Failure>(HasSubstr("'--listen'")))
      << "taken";
}

}  // namespace
}  // namespace haptolith
