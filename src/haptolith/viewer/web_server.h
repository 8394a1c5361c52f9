#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "haptolith/viewer/board.h"

namespace haptolith {

inline constexpr std::size_t kLargestUpload = std::size_t{32} << 20;

/// A way in: an address of the page with its token.
struct Entrance {
  std::string token = {};  ///< token that clients must present; empty: none
  bool nameless = false;   ///< clients of this entrance receive no soil and body names (blinded)
};

struct WebServerOptions {
  std::string bind = "127.0.0.1";  ///< an address; "localhost" is 127.0.0.1
  std::uint16_t port = 8080;       ///< the first that is tried; 0: any
  bool other_ports = true;         ///< whether the next ones are tried, too, where that is in use
  /// One without a token only when it is the only one and `bind` is loopback.
  std::vector<Entrance> entrances = {{}};
  /// Whether a user has chosen the token: wrong ones are then limited in rate for each address. Tokens of newToken()
  /// are unguessable, and guessing cannot lock out other clients.
  bool guessable = false;
  /// Connections that have not sent a whole request yet, and those that stay after one; fewer where the system limits
  /// the program's files. Large enough that crowding others out takes longer than another client's request.
  std::size_t most_asking = 2048, most_served = 512;
  /// Whether pages may upload files, of at most kLargestUpload bytes: see WebServer::takeUpload().
  bool takes_uploads = false;
};

/// @throws InvalidParameter for an invalid address, an entrance that needs a token and has none, two with the
/// same.
void validate(const WebServerOptions& options);

/// Serves the page, and a WebSocket each to at most 32 clients (docs/reference/web-protocol.md), on a thread of its
/// own. It does not interpret messages. A client that sends more than the protocol allows is dropped with its pending
/// messages. Idle connections, however many, do not block other clients.
class WebServer {
 public:
  struct Event {
    enum class Kind { kJoined, kMessage, kLeft };
    Kind kind = Kind::kMessage;
    std::uint32_t client = 0;
    std::string text;
    std::size_t entrance = 0;  ///< by which one has joined
  };

  /// Listens. @throws InvalidParameter as validate(); Failure when none of the ports it tries is free.
  WebServer(const WebServerOptions& options, Board& board);
  ~WebServer();

  /// Address of the page, the entrance's token included. Where it listens on all addresses: one of this machine that
  /// others can open as well, if it has any.
  [[nodiscard]] std::string url(std::size_t entrance = 0) const;
  /// As above for a browser on this machine.
  [[nodiscard]] std::string urlHere(std::size_t entrance = 0) const;
  [[nodiscard]] std::uint16_t port() const noexcept;
  [[nodiscard]] std::size_t clients() const noexcept;

  // For one thread that is not the server's. None of them waits for a client.

  /// The next thing that has happened: messages from all clients in turn, and each client's in their order. False when
  /// there is nothing.
  bool takeEvent(Event& event);
  /// Notifies all clients of news on the board.
  void notify();
  /// Sends a text to one client, after what it has been sent before. One that lets too many wait is dropped.
  void send(std::uint32_t client, std::string text);
  /// Takes an uploaded file by the number in the answer to the upload; null when it is no longer available.
  /// One upload is kept, the newest.
  std::shared_ptr<const std::string> takeUpload(std::uint64_t number);
  /// Lets who has a token download this file as /recordings/NAME, and no other; not who comes by a nameless entrance.
  void offer(const std::filesystem::path& file);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace haptolith
