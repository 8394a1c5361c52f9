#pragma once

#include <boost/asio/ip/udp.hpp>

#include <string_view>

namespace haptolith {

/// "127.0.0.1:7400", "[::1]:7400" or "localhost:7400". @throws InvalidParameter for anything else.
[[nodiscard]] boost::asio::ip::udp::endpoint endpointOf(const char* key, std::string_view text);

/// Opens a socket there that does not wait. @throws Failure when that cannot be.
void openAt(const char* key, const boost::asio::ip::udp::endpoint& where, boost::asio::ip::udp::socket& socket);

}  // namespace haptolith
