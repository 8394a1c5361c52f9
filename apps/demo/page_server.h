#pragma once

#include <functional>
#include <string>

namespace haptolith::demo {

/// Replacement for the WebSocket between the view and the page: the view's WebServer with one client, the page that has
/// started it. All on one thread.
class Page {
 public:
  /// Receiver of messages for the page.
  std::function<void(const std::string& bytes, bool binary)> post;

  /// Reports that the page has connected, and a message that it has sent.
  static void come();
  static void sent(std::string text);
  /// Reports that the page has received a message. Snapshots are sent only while few are in transit.
  static void took();
  /// Stores a file from the page for the command `tool_file`. @return its number.
  static double brought(std::string bytes);
};

[[nodiscard]] Page& page();

}  // namespace haptolith::demo
