#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "haptolith/session/session.h"
#include "haptolith/viewer/board.h"
#include "haptolith/viewer/command.h"
#include "haptolith/viewer/messages.h"
#include "haptolith/viewer/web_server.h"

namespace haptolith {

/// A session in the browser: shows it to viewers, and carries out their requests. Connects the session,
/// which it calls on its caller's thread, and the server, which has a separate thread; the loop depends on neither.
class LiveView {
 public:
  /// Recorder for the clients' requests; without functions nothing is recorded.
  struct Recorder {
    std::function<void()> start, stop;  ///< may throw Failure
    std::function<std::string()> name;  ///< name of the current file, else empty
  };

  /// Another part of the program that talks with clients over the view's WebSocket, on the thread that calls
  /// handleMessages(), and may keep them from commanding; functions that are missing refuse no command and understand
  /// no message.
  struct Extension {
    /// Does what a message with "do": "study" asks for; returns why it is refused, empty when it is done. May throw
    /// InvalidParameter or Failure, which refuses it as well.
    std::function<std::string(std::uint32_t client, std::string_view message)> handle;
    /// A client has come by an entrance: a number in WebServerOptions::entrances.
    std::function<void(std::uint32_t client, std::size_t entrance)> joined;
    std::function<void(std::uint32_t client)> left;
    /// Why this client may not have this command carried out now; empty: it may.
    std::function<std::string(std::uint32_t client, const Command& asked)> refuse;
  };

  /// Whether clients may command, or only look on and choose what they see.
  enum class Clients { kCommand, kLookOn };

  /// @throws InvalidParameter, Failure: as WebServer.
  LiveView(Session& session, const WebServerOptions& options, std::string_view version, Recorder recorder,
           Extension extension = {}, Clients clients = Clients::kCommand);

  [[nodiscard]] std::string url(std::size_t entrance = 0) const { return server_.url(entrance); }
  [[nodiscard]] std::string urlHere(std::size_t entrance = 0) const { return server_.urlHere(entrance); }
  [[nodiscard]] std::uint16_t port() const noexcept { return server_.port(); }
  [[nodiscard]] std::size_t clients() const noexcept { return server_.clients(); }

  /// Does what clients have asked for, for 2 ms at most; the rest waits for the next time. Call it as often as
  /// Session::poll(), before it.
  void handleMessages();
  /// Shows what is new. `newer` and `changed` are what Session::update() and poll() said.
  void show(bool newer, bool changed);

  /// State of the following robot, sent with the next status; empty if there is none.
  void setRobot(std::optional<RobotShown> robot) { robot_ = std::move(robot); }

  /// Sends a client a message of the extension's, a whole JSON object. A client that lets too many wait is dropped; for
  /// one that has left nothing happens.
  void send(std::uint32_t client, std::string text) { server_.send(client, std::move(text)); }
  /// Releases each tool for the client that holds it, if one does.
  void releaseTools();

 private:
  [[nodiscard]] std::string answer(std::uint32_t client, const ClientMessage& message, std::string_view text);
  [[nodiscard]] std::string refusal(std::uint32_t client, const ClientMessage& message) const;
  void carryOut(std::uint32_t client, const Command& asked);
  void releaseToolsOf(std::uint32_t client);
  [[nodiscard]] std::size_t freeTool(std::uint32_t client, const std::optional<std::string>& name) const;
  [[nodiscard]] std::vector<BesideTool> besideTools() const;
  void showScene();
  void showStatus();
  [[nodiscard]] std::string recordingNow();

  Session& session_;
  Recorder recorder_;
  Extension extension_;
  Clients clients_;
  Board board_;
  WebServer server_;
  FrameSpace space_;

  std::string recording_;                         ///< the file that was being written when last looked
  std::filesystem::path recorded_;                ///< the last one that is finished
  std::map<std::size_t, std::uint32_t> holders_;  ///< clients, by the tool that each holds
  std::optional<RobotShown> robot_;
  std::set<std::uint32_t> coloured_by_force_;
  std::uint32_t scene_shown_ = 0;
  bool scene_changed_ = true;
  std::vector<float> loads_n_;
  std::chrono::steady_clock::time_point loads_at_, status_at_, rate_at_;
  std::uint64_t rate_ticks_ = 0;
  double rate_hz_ = 0;
};

}  // namespace haptolith
