#include "haptolith/teleop/link/udp_relay.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <optional>

#include "haptolith/core/error.h"
#include "haptolith/teleop/link/udp_address.h"

namespace haptolith {

namespace {

namespace asio = boost::asio;
using Udp = asio::ip::udp;
using Clock = std::chrono::steady_clock;
using Error = boost::system::error_code;

constexpr std::size_t kLargestRelayed = 65536;
/// Limit of packets under way in each direction: four minutes of 150 bytes at 1 kHz. It bounds the memory of a
/// flood.
constexpr std::size_t kMostBytesOnTheWay = std::size_t{64} << 20;
constexpr double kPeerForgottenAfter_s = 10;

}  // namespace

class UdpRelay::Implementation {
 public:
  Implementation(const LinkParameters& up, const LinkParameters& down, const UdpRelayOptions& options)
      : up_(up), down_(down), robot_(endpointOf("connect", options.to)) {
    openAt("listen", endpointOf("listen", options.listen), operator_socket_);
    openAt("connect", {robot_.address().is_v6() ? Udp::v6() : Udp::v4(), 0}, robot_socket_);
    hear(operator_socket_, operator_buffer_, [this](std::size_t bytes) { fromOperator(bytes); });
    hear(robot_socket_, robot_buffer_, [this](std::size_t bytes) { fromRobot(bytes); });
  }

  void run(double duration_s) {
    io_.restart();
    io_.run_for(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(duration_s)));
    if (failed_) {
      throw Failure(fmt::format("the relay failed: {}", failed_.message()));
    }
  }

  [[nodiscard]] std::uint16_t port() const { return operator_socket_.local_endpoint().port(); }
  [[nodiscard]] const Link& up() const noexcept { return up_; }
  [[nodiscard]] const Link& down() const noexcept { return down_; }
  [[nodiscard]] std::uint64_t ignored() const noexcept { return ignored_; }

 private:
  struct Buffer {
    std::array<std::uint8_t, kLargestRelayed> bytes;
    Udp::endpoint from;
  };

  [[nodiscard]] double now() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }

  template <class Take>
  void hear(Udp::socket& socket, Buffer& buffer, Take take) {
    socket.async_receive_from(asio::buffer(buffer.bytes), buffer.from,
                              [this, &socket, &buffer, take](Error error, std::size_t bytes) {
                                // An unreachable receiver of the last packet is no reason to end.
                                if (error && error != asio::error::connection_refused) {
                                  failed_ = error;
                                  io_.stop();
                                  return;
                                }
                                if (!error) {
                                  take(bytes);
                                }
                                hear(socket, buffer, take);
                              });
  }

  void fromOperator(std::size_t bytes) {
    const double now_s = now();
    if (!operator_ || now_s - heard_s_ > kPeerForgottenAfter_s) {
      operator_ = operator_buffer_.from;
    }
    if (operator_buffer_.from != *operator_) {
      ++ignored_;
      return;
    }
    heard_s_ = now_s;
    take(up_, operator_buffer_, bytes);
  }

  void fromRobot(std::size_t bytes) {
    if (!operator_ || robot_buffer_.from != robot_) {
      ++ignored_;
      return;
    }
    take(down_, robot_buffer_, bytes);
  }

  void take(Link& way, const Buffer& buffer, std::size_t bytes) {
    if (way.bytesOnTheWay() >= kMostBytesOnTheWay) {
      ++ignored_;
      return;
    }
    way.send(now(), Packet(buffer.bytes.begin(), buffer.bytes.begin() + static_cast<std::ptrdiff_t>(bytes)));
    deliver();
  }

  /// Passes on what has arrived, and waits for the next.
  void deliver() {
    const double now_s = now();
    pass(up_, robot_socket_, robot_, now_s);
    if (operator_) {
      pass(down_, operator_socket_, *operator_, now_s);
    }
    std::optional<double> next_s = up_.nextArrival();
    if (const std::optional<double> back_s = down_.nextArrival(); back_s && (!next_s || *back_s < *next_s)) {
      next_s = back_s;
    }
    if (!next_s) {
      return;
    }
    timer_.expires_at(began_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(*next_s)) +
                      std::chrono::nanoseconds(1));
    timer_.async_wait([this](Error error) {
      if (!error) {
        deliver();
      }
    });
  }

  static void pass(Link& way, Udp::socket& socket, const Udp::endpoint& to, double now_s) {
    while (const std::optional<Link::Arrival> arrival = way.receive(now_s)) {
      Error lost;  // lost like any undeliverable packet of a network
      socket.send_to(asio::buffer(arrival->packet), to, 0, lost);
    }
  }

  asio::io_context io_{1};
  Udp::socket operator_socket_{io_}, robot_socket_{io_};
  asio::steady_timer timer_{io_};
  Clock::time_point began_ = Clock::now();
  Link up_, down_;
  Udp::endpoint robot_;
  std::optional<Udp::endpoint> operator_;
  double heard_s_ = 0;
  Buffer operator_buffer_, robot_buffer_;
  std::uint64_t ignored_ = 0;
  Error failed_;
};

UdpRelay::UdpRelay(const LinkParameters& up, const LinkParameters& down, const UdpRelayOptions& options)
    : implementation_(std::make_unique<Implementation>(up, down, options)) {}
UdpRelay::~UdpRelay() = default;

void UdpRelay::run(double duration_s) {
  implementation_->run(duration_s);
}
std::uint16_t UdpRelay::port() const {
  return implementation_->port();
}
const LinkCounts& UdpRelay::up() const noexcept {
  return implementation_->up().counts();
}
const LinkCounts& UdpRelay::down() const noexcept {
  return implementation_->down().counts();
}
std::uint64_t UdpRelay::ignored() const noexcept {
  return implementation_->ignored();
}

}  // namespace haptolith
