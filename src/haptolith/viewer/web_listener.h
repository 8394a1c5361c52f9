#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/system/error_code.hpp>

#include <optional>

#include "haptolith/viewer/web_server.h"

namespace haptolith {

/// IP address that the options name; none if they name another thing.
[[nodiscard]] std::optional<boost::asio::ip::address> addressOf(const WebServerOptions& options);

/// Lets `acceptor` listen where the options say, at the first port of theirs that is free.
[[nodiscard]] boost::system::error_code listenAsAsked(boost::asio::ip::tcp::acceptor& acceptor,
                                                      const WebServerOptions& options);

}  // namespace haptolith
