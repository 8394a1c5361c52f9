#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "haptolith/viewer/frame.h"

namespace haptolith {

/// What every client shall see: the scene, the status, the newest picture. One thread puts it up; others ask what there
/// is that a client has not seen yet. A client that asks seldom misses what lies between: nothing is queued for it.
class Board {
 public:
  /// What one client has seen already.
  struct Seen {
    bool nameless = false;  ///< is not told what soil and world it sees
    bool hello = false;
    std::uint32_t scene = 0, status = 0, frame = 0;
  };
  struct Message {
    std::shared_ptr<const std::string> bytes;
    bool binary = false;
  };

  /// The first message to everybody is `hello`, in which "$client" stands for the client's number.
  explicit Board(std::string hello) : hello_(std::move(hello)) {}

  /// A scene's message, and the same without what soil and world it is.
  struct SceneTexts {
    std::string whole, nameless;
  };
  /// Another scene, or other values of the one that is shown. With `particles` pictures begin anew.
  void setScene(const SceneTexts& texts);
  void setScene(const SceneTexts& texts, std::uint32_t scene, std::size_t particles, const FrameEncoder::Space& space);
  void setStatus(std::string text);
  void setPicture(const SceneSnapshot& snapshot, const FrameEncoder::Beside& beside);

  /// The next message for a client, of which it is then taken to have seen it; none when it has seen everything.
  [[nodiscard]] std::optional<Message> next(std::uint32_t client, Seen& seen);

 private:
  void put(const SceneTexts& texts);

  std::mutex mutex_;
  std::string hello_;
  std::shared_ptr<const std::string> scene_, nameless_scene_, status_;
  std::uint32_t scene_version_ = 0, status_version_ = 0;
  std::optional<FrameEncoder> encoder_;
};

}  // namespace haptolith
