#include "haptolith/teleop/link/udp_port.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "haptolith/core/error.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/teleop/link/udp_address.h"

namespace haptolith {

namespace {

namespace asio = boost::asio;
using Udp = asio::ip::udp;
using Error = boost::system::error_code;

constexpr std::size_t kLargestDatagram = 65536;

std::string textOf(const Udp::endpoint& endpoint) {
  const std::string host = endpoint.address().to_string();
  return endpoint.address().is_v6() ? fmt::format("[{}]:{}", host, endpoint.port())
                                    : fmt::format("{}:{}", host, endpoint.port());
}

}  // namespace

Udp::endpoint endpointOf(const char* key, std::string_view text) {
  const std::size_t colon = text.rfind(':');
  const std::string_view digits = colon == std::string_view::npos ? std::string_view() : text.substr(colon + 1);
  std::uint16_t port = 0;
  const auto [end, wrong] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  std::string host(text.substr(0, std::min(colon, text.size())));
  if (host.starts_with('[') && host.ends_with(']')) {
    host = host.substr(1, host.size() - 2);
  }
  Error error;
  const asio::ip::address address = asio::ip::make_address(host == "localhost" ? "127.0.0.1" : host, error);
  if (error || wrong != std::errc{} || end != digits.data() + digits.size()) {
    throw InvalidParameter(key, inQuotes(text),
                           "HOST:PORT with an IP address or localhost, for example 127.0.0.1:7400");
  }
  return {address, port};
}

void openAt(const char* key, const Udp::endpoint& where, Udp::socket& socket) {
  Error error;
  socket.open(where.protocol(), error);
  if (!error) {
    socket.bind(where, error);
  }
  if (!error) {
    socket.non_blocking(true, error);
  }
  if (error) {
    throw Failure(fmt::format("cannot use {} for '{}': {}", textOf(where), key, error.message()));
  }
}

class UdpPort::Implementation {
 public:
  Implementation(const char* key, std::string_view listen) { openAt(key, endpointOf(key, listen), socket_); }

  std::optional<Datagram> receive() {
    Udp::endpoint from;
    Error error;
    std::size_t bytes = 0;
    do {  // an unreachable receiver of the last packet is reported here
      bytes = socket_.receive_from(asio::buffer(buffer_), from, 0, error);
    } while (error == asio::error::connection_refused);
    if (error) {
      return std::nullopt;
    }
    return Datagram{textOf(from), Packet(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(bytes))};
  }

  void send(std::string_view to, const Packet& bytes) {
    Error lost;
    socket_.send_to(asio::buffer(bytes), endpointOf("connect", to), 0, lost);
  }

  [[nodiscard]] Udp::endpoint here() const { return socket_.local_endpoint(); }

 private:
  asio::io_context io_{1};
  Udp::socket socket_{io_};
  std::array<std::uint8_t, kLargestDatagram> buffer_{};
};

UdpPort::UdpPort(const char* key, std::string_view listen)
    : implementation_(std::make_unique<Implementation>(key, listen)) {}
UdpPort::~UdpPort() = default;

std::optional<UdpPort::Datagram> UdpPort::receive() {
  return implementation_->receive();
}
void UdpPort::send(std::string_view to, const Packet& bytes) {
  implementation_->send(to, bytes);
}
std::uint16_t UdpPort::port() const {
  return implementation_->here().port();
}

}  // namespace haptolith
