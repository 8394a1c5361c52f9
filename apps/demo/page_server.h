#pragma once

#include <functional>
#include <string>

namespace haptolith::demo {

/// What stands in for the WebSocket between the view and the page: the view's WebServer, whose one client is the page
/// that has started it. All on one thread.
class Page {
 public:
  /// Where messages for the page go.
  std::function<void(const std::string& bytes, bool binary)> post;

  /// The page has come; and it has sent this.
  static void come();
  static void sent(std::string text);
  /// The page has taken one of the messages that it was sent. It is sent pictures only while few are on their way.
  static void took();
  /// The page has brought a file for the command `tool_file`; @return its number.
  static double brought(std::string bytes);
};

[[nodiscard]] Page& page();

}  // namespace haptolith::demo
