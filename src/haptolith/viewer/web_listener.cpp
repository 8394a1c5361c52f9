#include "haptolith/viewer/web_listener.h"

#include <boost/asio/error.hpp>

#include <cstdint>

#include "haptolith/core/platform/udp_socket.h"

namespace haptolith {

namespace asio = boost::asio;

namespace {

constexpr int kPortsTried = 100;

}  // namespace

std::optional<asio::ip::address> addressOf(const WebServerOptions& options) {
  boost::system::error_code error;
  const auto address = asio::ip::make_address(options.bind == "localhost" ? "127.0.0.1" : options.bind, error);
  return error ? std::nullopt : std::optional(address);
}

boost::system::error_code listenAsAsked(asio::ip::tcp::acceptor& acceptor, const WebServerOptions& options) {
  const std::optional<asio::ip::address> address = addressOf(options);
  boost::system::error_code error = asio::error::invalid_argument;
  const int tried = options.other_ports ? kPortsTried : 1;
  for (int i = 0; address && i < tried; ++i) {
    const auto port = static_cast<std::uint16_t>(options.port == 0 ? 0 : options.port + i);
    const asio::ip::tcp::endpoint endpoint(*address, port);
    acceptor = asio::ip::tcp::acceptor(acceptor.get_executor());
    acceptor.open(endpoint.protocol(), error);
    if (!error && !kReuseTakesPortsInUse) {
      acceptor.set_option(asio::socket_base::reuse_address(true), error);
    }
    if (!error) {
      acceptor.bind(endpoint, error);
    }
    if (!error) {
      acceptor.listen(asio::socket_base::max_listen_connections, error);
    }
    if (!error || error != asio::error::address_in_use || port == 65535) {
      break;
    }
  }
  return error;
}

}  // namespace haptolith
