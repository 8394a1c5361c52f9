// Data from a socket: garbage instead of a request, or, after a valid upgrade, instead of frames. The server answers or
// closes the connection, and continues to serve.

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/streambuf.hpp>
#include <boost/asio/write.hpp>
#include <boost/system/error_code.hpp>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "haptolith/viewer/web_server.h"

namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr const char* kUpgrade =
    "GET /ws HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: haptolith.1\r\n\r\n";

struct Target {
  haptolith::Board board{"hello"};
  haptolith::WebServer server{{.port = 0, .takes_uploads = true}, board};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Target target;
  if (size == 0) {
    return 0;
  }
  asio::io_context io;
  asio::ip::tcp::socket socket(io);
  error_code error;
  const asio::ip::tcp::endpoint server(asio::ip::make_address("127.0.0.1"), target.server.port());
  socket.connect(server, error);
  const auto passes =
      [](const error_code& why) {  // retries: a closed connection keeps its port for 1 min; libFuzzer has alarms
        return why == boost::system::errc::address_not_available || why == boost::system::errc::interrupted;
      };
  for (int tries = 0; passes(error) && tries < 600; ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    socket.close();
    socket.connect(server, error);
  }
  if (error) {
    std::fprintf(stderr, "it no longer serves: %s\n", error.message().c_str());
    std::abort();
  }
  socket.set_option(asio::socket_base::linger(true, 0), error);  // otherwise thousands of ports stay blocked
  if (data[0] % 2 == 1) {                                        // a client with garbage frames
    asio::write(socket, asio::buffer(kUpgrade, std::char_traits<char>::length(kUpgrade)), error);
    asio::streambuf answer;
    asio::read_until(socket, answer, "\r\n\r\n", error);
  }
  asio::write(socket, asio::buffer(data + 1, size - 1), error);
  socket.shutdown(asio::socket_base::shutdown_send, error);
  std::array<char, 4096> answer{};
  while (!error) {  // until the server closes the connection
    socket.read_some(asio::buffer(answer), error);
  }
  for (haptolith::WebServer::Event event; target.server.takeEvent(event);) {
  }
  return 0;
}
