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
  std::string token = {};  ///< what clients must know; empty: nothing
  bool nameless = false;   ///< who comes this way is not told what soil and world they see
};

struct WebServerOptions {
  std::string bind = "127.0.0.1";  ///< an address; "localhost" is 127.0.0.1
  std::uint16_t port = 8080;       ///< the first that is tried; 0: any
  bool other_ports = true;         ///< whether the next ones are tried, too, where that is in use
  /// One without a token only when it is the only one and `bind` is loopback.
  std::vector<Entrance> entrances = {{}};
  /// Whether somebody has thought up a token: then wrong ones are taken slowly from each address. One that newToken()
  /// has made up nobody guesses, and nobody can be kept out by guessing.
  bool guessable = false;
  /// Connections that have not sent a whole request yet, and those that stay after one; fewer where the system lets the
  /// program have few files. So many that who crowds others out by the thousand needs a while for it, in which anybody
  /// else has sent a request.
  std::size_t most_asking = 2048, most_served = 512;
  /// Whether pages may upload files, of at most kLargestUpload bytes: see WebServer::takeUpload().
  bool takes_uploads = false;
};

/// @throws InvalidParameter for an invalid address, an entrance that needs a token and has none, two with the
/// same.
void validate(const WebServerOptions& options);

/// Serves the page, and a WebSocket each to at most 32 clients (docs/reference/web-protocol.md), on a thread of its
/// own. It knows nothing of what the messages mean. A client that sends more than the protocol allows is dropped, and
/// so is what waits of it. Connections that ask for nothing, however many, keep nobody else out.
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
  /// The same for a browser on this machine.
  [[nodiscard]] std::string urlHere(std::size_t entrance = 0) const;
  [[nodiscard]] std::uint16_t port() const noexcept;
  [[nodiscard]] std::size_t clients() const noexcept;

  // For one thread that is not the server's. None of them waits for a client.

  /// The next thing that has happened: messages from all clients in turn, and each client's in their order. False when
  /// there is nothing.
  bool takeEvent(Event& event);
  /// Tells all clients that the board has something new.
  void notify();
  /// Sends a text to one client, after what it has been sent before. One that lets too many wait is dropped.
  void send(std::uint32_t client, std::string text);
  /// Takes over what somebody has uploaded, by the number that the answer gave them; null when it is no longer there.
  /// One upload is kept, the newest.
  std::shared_ptr<const std::string> takeUpload(std::uint64_t number);
  /// Lets who has a token download this file as /recordings/NAME, and no other; not who comes by a nameless entrance.
  void offer(const std::filesystem::path& file);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace haptolith
