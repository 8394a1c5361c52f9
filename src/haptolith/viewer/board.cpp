#include "haptolith/viewer/board.h"

#include <utility>

#include "haptolith/viewer/frame.h"

namespace haptolith {

Board::Board(Texts hello) : hello_(std::move(hello)) {}
Board::Board(const std::string& hello) : Board(Texts{hello, hello}) {}
Board::~Board() = default;

void Board::setScene(const Texts& texts) {
  const std::scoped_lock lock(mutex_);
  if (scene_ && *scene_.whole == texts.whole) {
    return;
  }
  put(texts);
}

void Board::setScene(const Texts& texts, std::uint32_t scene, std::size_t particles, const FrameSpace& space) {
  const std::scoped_lock lock(mutex_);
  put(texts);
  encoder_ = std::make_unique<FrameEncoder>(scene, particles, space, encoder_ ? encoder_->number() : 0);
}

Board::Shared Board::shared(const Texts& texts) {
  return {std::make_shared<const std::string>(texts.whole), std::make_shared<const std::string>(texts.nameless)};
}

void Board::put(const Texts& texts) {
  scene_ = shared(texts);
  ++scene_version_;
}

void Board::setStatus(const Texts& texts) {
  const std::scoped_lock lock(mutex_);
  status_ = shared(texts);
  ++status_version_;
}

void Board::setPicture(const SceneSnapshot& snapshot, const BesideSnapshot& beside) {
  const std::scoped_lock lock(mutex_);
  encoder_->take(snapshot, beside);
}

std::optional<Board::Message> Board::next(std::uint32_t client, Seen& seen) {
  const std::scoped_lock lock(mutex_);
  if (!seen.hello) {
    constexpr std::string_view kPlace = "\"$client\"";
    seen.hello = true;
    std::string hello = seen.nameless ? hello_.nameless : hello_.whole;
    if (const std::size_t at = hello.find(kPlace); at != std::string::npos) {
      hello.replace(at, kPlace.size(), std::to_string(client));
    }
    return Message{std::make_shared<const std::string>(std::move(hello))};
  }
  if (scene_ && seen.scene != scene_version_) {
    seen.scene = scene_version_;
    return Message{scene_.of(seen)};
  }
  // Before the picture: of that there is always a newer one for a client that is slow.
  if (status_ && seen.status != status_version_) {
    seen.status = status_version_;
    return Message{status_.of(seen)};
  }
  if (encoder_ && encoder_->hasPicture() && seen.frame != encoder_->number()) {
    const std::shared_ptr<const std::string> frame = encoder_->frameSince(seen.frame);
    seen.frame = encoder_->number();
    return Message{frame, true};
  }
  return std::nullopt;
}

}  // namespace haptolith
