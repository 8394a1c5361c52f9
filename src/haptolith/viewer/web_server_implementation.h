#pragma once

// The parts of the web server, for web_server.cpp alone.

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "haptolith/viewer/access.h"
#include "haptolith/viewer/board.h"
#include "haptolith/viewer/web_server.h"

namespace haptolith {

namespace asio = boost::asio;
namespace beast = boost::beast;
using Tcp = asio::ip::tcp;
using namespace std::chrono_literals;

inline constexpr std::string_view kSubprotocol = "haptolith.1";
inline constexpr double kMostGuesses =
    20;                                  // wrong tokens at once, from a network; a page that comes back with an old one
inline constexpr auto kHeaderTime = 3s;  // for the first request

inline std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}
inline beast::string_view view(std::string_view text) {
  return {text.data(), text.size()};
}

class WebServer::Implementation {
 public:
  Implementation(const WebServerOptions& options, Board& shared_board);
  ~Implementation();

  class Client;
  class Visitor;

  /// Wrong tokens that a network may still send.
  struct Guesses {
    double left = kMostGuesses;
    std::chrono::steady_clock::time_point at;
  };
  /// Visitors by where they are, of each place the oldest first.
  struct Crowd {
    std::map<std::string, std::list<Visitor*>> from;
    std::size_t size = 0;
  };

  void serve() noexcept;
  void accept();
  void admit(Tcp::socket socket);
  static void sendAwayOneOf(Crowd& crowd);
  /// Whether a network may try a token now; counts one that is wrong.
  [[nodiscard]] bool mayGuess(const std::string& network, bool wrong);
  /// Number of the entrance that a request's token opens.
  [[nodiscard]] std::optional<std::size_t> entranceOf(std::string_view target) const;
  [[nodiscard]] std::string urlAt(const asio::ip::address& address, std::size_t entrance) const;
  [[nodiscard]] bool isHostAllowed(std::string_view host) const { return !loopback_only || namesLoopback(host); }
  void join(const std::shared_ptr<Client>& client);
  void leave(std::uint32_t client);
  bool push(Event event);
  void forget(std::uint32_t client);
  /// Keeps an upload, the newest alone; @return its number.
  std::uint64_t keepUpload(std::string bytes);

  bool ends = false;       // outlives io, which destroys the clients that are left
  bool accepting = false;  ///< or about to, after a pause
  std::size_t most_asking = 0, most_served = 0;
  Crowd asking, served;                                    // for the server's thread, like all members below
  std::map<std::uint32_t, std::weak_ptr<Client>> clients;  // those that have not ended
  std::size_t sockets_of_clients = 0;
  std::uint32_t last_client = 0;
  std::map<std::string, Guesses> guesses;                             // by network
  std::map<std::string, std::filesystem::path, std::less<>> offered;  // by name

  asio::io_context io{1};  // its end is that of visitors and clients, who use the above
  Tcp::acceptor acceptor{io};
  asio::steady_timer pause{io};
  Board& board;
  std::vector<Entrance> entrances;
  bool guessable = false, takes_uploads = false;
  bool uploading = false;  ///< an upload is running: one at a time
  bool loopback_only = true;
  std::atomic<std::size_t> joined{0};

  /// Pending messages of a client.
  struct Queue {
    std::deque<Event> events;
    std::size_t bytes = 0;
  };
  std::mutex mutex;
  std::map<std::uint32_t, Queue> queues;  // none of them empty
  std::uint32_t last_taken = 0;
  std::uint64_t last_upload = 0;
  std::shared_ptr<const std::string> upload;
  std::atomic<bool> notified{false};
  std::thread thread;
};

}  // namespace haptolith
