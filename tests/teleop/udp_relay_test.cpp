#include "haptolith/teleop/link/udp_relay.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <gmock/gmock.h>

#include <array>
#include <atomic>
#include <chrono>
#include <optional>
#include <string>
#include <thread>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;
namespace asio = boost::asio;
using Udp = asio::ip::udp;
using Clock = std::chrono::steady_clock;

/// A program at one end.
class End {
 public:
  [[nodiscard]] Udp::endpoint where() const { return socket_.local_endpoint(); }
  [[nodiscard]] std::string address() const { return "127.0.0.1:" + std::to_string(where().port()); }

  void send(const std::string& text, std::uint16_t port) {
    socket_.send_to(asio::buffer(text), {asio::ip::address_v4::loopback(), port});
  }
  /// The next datagram; none within this time.
  std::optional<std::string> receive(std::chrono::milliseconds within = 5s) {
    socket_.non_blocking(true);
    for (const auto end = Clock::now() + within; Clock::now() < end; std::this_thread::sleep_for(200us)) {
      std::array<char, 70'000> bytes;
      boost::system::error_code error;
      const std::size_t count = socket_.receive_from(asio::buffer(bytes), from_, 0, error);
      if (!error) {
        return std::string(bytes.data(), count);
      }
    }
    return std::nullopt;
  }
  /// To where the last one came from.
  void answer(const std::string& text) { socket_.send_to(asio::buffer(text), from_); }

 private:
  asio::io_context io_;
  Udp::socket socket_{io_, {asio::ip::address_v4::loopback(), 0}};
  Udp::endpoint from_;
};

/// A relay at work.
class RelayTest : public testing::Test {
 protected:
  void start(const LinkParameters& up, const LinkParameters& down) {
    relay_.emplace(up, down, UdpRelayOptions{.listen = "localhost:0", .to = robot_.address()});
    port_ = relay_->port();
    thread_ = std::thread([this] {
      while (!stop_) {
        relay_->run(0.01);
      }
    });
  }
  void end() {
    stop_ = true;
    if (thread_.joinable()) {
      thread_.join();
    }
  }
  void TearDown() override { end(); }

  End operator_, robot_, stranger_;
  std::optional<UdpRelay> relay_;
  std::uint16_t port_ = 0;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

TEST_F(RelayTest, PassesPacketsOnAndBackLate) {
  start({.delay_s = 0.05}, {.delay_s = 0.1});
  const auto began = Clock::now();
  operator_.send("down there", port_);
  ASSERT_EQ(robot_.receive(), "down there");
  EXPECT_GE(Clock::now() - began, 50ms);
  robot_.answer("up here");
  ASSERT_EQ(operator_.receive(), "up here");
  EXPECT_GE(Clock::now() - began, 150ms);
  const std::string large(60'000, 'x');
  operator_.send(large, port_);
  EXPECT_EQ(robot_.receive(), large);
  operator_.send("", port_);
  EXPECT_EQ(robot_.receive(), "");
  end();
  EXPECT_EQ(relay_->up().arrived, 3U);
  EXPECT_EQ(relay_->down().arrived, 1U);
  EXPECT_EQ(relay_->ignored(), 0U);
}

TEST_F(RelayTest, KeepsTheOrderAndLosesItsShare) {
  start({.delay_s = 0.02, .jitter_s = 0.005, .loss = 0.5}, {});
  constexpr int kPackets = 400;
  for (int i = 0; i < kPackets; ++i) {
    operator_.send(std::to_string(i), port_);
    std::this_thread::sleep_for(100us);
  }
  int before = -1;
  int came = 0;
  while (const std::optional<std::string> packet = robot_.receive(300ms)) {
    EXPECT_GT(std::stoi(*packet), before);
    before = std::stoi(*packet);
    ++came;
  }
  end();
  EXPECT_EQ(relay_->up().arrived, static_cast<std::uint64_t>(came));
  EXPECT_NEAR(came, 0.5 * kPackets, 50);
}

TEST_F(RelayTest, HearsNobodyButItsTwoEnds) {
  start({}, {});
  operator_.send("hello", port_);
  ASSERT_EQ(robot_.receive(), "hello");
  stranger_.send("let me", port_);
  EXPECT_EQ(robot_.receive(100ms), std::nullopt);
  robot_.answer("yes?");
  EXPECT_EQ(operator_.receive(), "yes?");
  EXPECT_EQ(stranger_.receive(50ms), std::nullopt);
  end();
  EXPECT_EQ(relay_->ignored(), 1U);
}

TEST_F(RelayTest, GoesOnWhenNobodyListensAtTheOtherEnd) {
  const std::string there = [] { return End().address(); }();
  relay_.emplace(LinkParameters{}, LinkParameters{}, UdpRelayOptions{.listen = "localhost:0", .to = there});
  for (int i = 0; i < 3; ++i) {
    operator_.send("anybody?", relay_->port());
    EXPECT_NO_THROW(relay_->run(0.05));
  }
  EXPECT_EQ(relay_->up().arrived, 3U);
}

TEST(UdpRelay, RefusesWhatIsNoAddress) {
  for (const char* wrong : {"", "localhost", "localhost:", "localhost:x", "example.com:7", "127.0.0.1:70000", ":7"}) {
    EXPECT_THROW(UdpRelay({}, {}, {.listen = "127.0.0.1:0", .to = wrong}), InvalidParameter) << wrong;
    EXPECT_THROW(UdpRelay({}, {}, {.listen = wrong, .to = "127.0.0.1:7"}), InvalidParameter) << wrong;
  }
  const UdpRelay taken({}, {}, {.listen = "127.0.0.1:0", .to = "127.0.0.1:7"});
  EXPECT_THROW(UdpRelay({}, {}, {.listen = "127.0.0.1:" + std::to_string(taken.port()), .to = "127.0.0.1:7"}), Failure);
}

}  // namespace
}  // namespace haptolith
