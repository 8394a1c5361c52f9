// WebServer of the view for a page in the same browser. It implements the program's declaration, so that the view is
// unchanged.

#include "page_server.h"

#include <deque>
#include <memory>
#include <utility>

#include "haptolith/viewer/web_server.h"

namespace haptolith {

namespace {

constexpr std::uint32_t kPage = 1;  // number of the only client
constexpr int kMostOnTheirWay = 2;  // a page that draws slowly misses snapshots, like a slow client of the program

struct {
  std::deque<WebServer::Event> events;
  Board::Seen seen;
  int on_their_way = 0;
  bool is_there = false;
  std::shared_ptr<const std::string> upload;
  std::uint64_t uploads = 0;
} state;

Board* board = nullptr;

void post(const std::string& bytes, bool binary) {
  ++state.on_their_way;
  demo::page().post(bytes, binary);
}

void postNews() {
  while (state.is_there && board != nullptr && state.on_their_way < kMostOnTheirWay) {
    const auto message = board->next(kPage, state.seen);
    if (!message) {
      return;
    }
    post(*message->bytes, message->binary);
  }
}

}  // namespace

namespace demo {

Page& page() {
  static Page only;
  return only;
}

void Page::come() {
  state.is_there = true;
  state.events.push_back({WebServer::Event::Kind::kJoined, kPage, {}, 0});
}

void Page::sent(std::string text) {
  state.events.push_back({WebServer::Event::Kind::kMessage, kPage, std::move(text), 0});
}

void Page::took() {
  --state.on_their_way;
  postNews();
}

double Page::brought(std::string bytes) {
  state.upload = std::make_shared<const std::string>(std::move(bytes));
  return static_cast<double>(++state.uploads);
}

}  // namespace demo

class WebServer::Implementation {};

/// Connects the page to a newly opened scene.
WebServer::WebServer(const WebServerOptions& /*options*/, Board& shown) {
  board = &shown;
  state.seen = {};
}

WebServer::~WebServer() {
  board = nullptr;
}

std::string WebServer::url(std::size_t /*entrance*/) const {
  return {};
}

std::string WebServer::urlHere(std::size_t /*entrance*/) const {
  return {};
}

std::uint16_t WebServer::port() const noexcept {
  return 0;
}

std::size_t WebServer::clients() const noexcept {
  return state.is_there ? 1 : 0;
}

bool WebServer::takeEvent(Event& event) {
  if (state.events.empty()) {
    return false;
  }
  event = std::move(state.events.front());
  state.events.pop_front();
  return true;
}

void WebServer::notify() {
  postNews();
}

void WebServer::send(std::uint32_t /*client*/, std::string text) {
  post(text, false);
}

std::shared_ptr<const std::string> WebServer::takeUpload(std::uint64_t number) {
  return number == state.uploads ? std::exchange(state.upload, nullptr) : nullptr;
}

void WebServer::offer(const std::filesystem::path& /*file*/) {}

}  // namespace haptolith
