#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace haptolith {

class FrameEncoder;
struct BesideSnapshot;
struct FrameSpace;
struct SceneSnapshot;

/// State for every client: the scene, the status, the newest picture. One thread posts it; others fetch the part that
/// a client has not seen yet. A slow client misses intermediate states: nothing is queued for it.
class Board {
 public:
  /// State that one client has seen.
  struct Seen {
    bool nameless = false;  ///< receives no names of soil and world (blinded)
    bool hello = false;
    std::uint32_t scene = 0, status = 0, frame = 0;
  };
  struct Message {
    std::shared_ptr<const std::string> bytes;
    bool binary = false;
  };

  /// A message, and the same without what soil and world it is.
  struct Texts {
    std::string whole, nameless;
  };

  /// The first message to each client is `hello`, in which "$client" is the client's number.
  explicit Board(Texts hello);
  explicit Board(const std::string& hello);
  ~Board();

  /// Sets another scene, or other values of the current one. With `particles` pictures restart.
  void setScene(const Texts& texts);
  void setScene(const Texts& texts, std::uint32_t scene, std::size_t particles, const FrameSpace& space);
  void setStatus(const Texts& texts);
  void setStatus(const std::string& text) { setStatus({text, text}); }
  void setPicture(const SceneSnapshot& snapshot, const BesideSnapshot& beside);

  /// The next message for a client, of which it is then taken to have seen it; none when it has seen everything.
  [[nodiscard]] std::optional<Message> next(std::uint32_t client, Seen& seen);

 private:
  /// A message as every client gets it that may, or may not, know the names.
  struct Shared {
    std::shared_ptr<const std::string> whole, nameless;

    explicit operator bool() const noexcept { return whole != nullptr; }
    [[nodiscard]] const std::shared_ptr<const std::string>& of(const Seen& seen) const noexcept {
      return seen.nameless ? nameless : whole;
    }
  };

  [[nodiscard]] static Shared shared(const Texts& texts);
  void put(const Texts& texts);

  std::mutex mutex_;
  Texts hello_;
  Shared scene_, status_;
  std::uint32_t scene_version_ = 0, status_version_ = 0;
  std::unique_ptr<FrameEncoder> encoder_;
};

}  // namespace haptolith
