#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/session/session.h"
#include "haptolith/viewer/board.h"
#include "haptolith/viewer/command.h"
#include "haptolith/viewer/web_server.h"

namespace haptolith {

/// A session in the browser: shows it to whoever looks on, and does what they ask for. Stands between the session,
/// which it asks on the thread that calls it, and the server, which has a thread of its own; the loop knows of neither.
class LiveView {
 public:
  /// Who writes what clients ask to be recorded; without functions nothing is.
  struct Recorder {
    std::function<void()> start, stop;  ///< may throw Failure
    std::function<std::string()> name;  ///< of the file while there is one, else empty
  };

  /// @throws InvalidParameter, Failure: as WebServer.
  LiveView(Session& session, const WebServerOptions& options, std::string_view version, Recorder recorder);

  [[nodiscard]] std::string url() const { return server_.url(); }

  /// Does what clients have asked for. Call it as often as Session::poll(), before it.
  void obey();
  /// Shows what is new. `newer` and `changed` are what Session::update() and poll() said.
  void show(bool newer, bool changed);

 private:
  void carryOut(std::uint32_t client, const Command& asked);
  void letGo(std::uint32_t client);
  void showScene();
  void showStatus();

  Session& session_;
  Recorder recorder_;
  Board board_;
  WebServer server_;
  FrameEncoder::Space space_;

  std::vector<WebServer::Event> events_;
  std::optional<std::uint32_t> holder_;
  std::set<std::uint32_t> coloured_by_force_;
  std::uint32_t scene_shown_ = 0;
  bool scene_changed_ = true;
  std::vector<float> loads_n_;
  std::chrono::steady_clock::time_point loads_at_, status_at_, rate_at_;
  std::uint64_t rate_ticks_ = 0;
  double rate_hz_ = 0;
};

}  // namespace haptolith
