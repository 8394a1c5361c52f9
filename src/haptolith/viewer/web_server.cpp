#include "haptolith/viewer/web_server.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/start_thread.h"
#include "haptolith/core/platform/this_program.h"
#include "haptolith/core/platform/udp_socket.h"
#include "haptolith/viewer/access.h"
#include "haptolith/viewer/web_listener.h"
#include "haptolith/viewer/web_visitor.h"

namespace haptolith {

namespace {

constexpr std::size_t kFilesForAll = 4096;
constexpr std::size_t kFilesOfOthers = 256;         // clients, recordings and whatever the rest of the program opens
constexpr std::size_t kMostBytesWaiting = 131'072;  // of a client
constexpr std::size_t kMostEventsWaiting = 2048;    // of a client
constexpr double kGuessesPerS = 1;                  // of a network, after kMostGuesses at once
constexpr std::size_t kMostGuessing = 1024;         // networks that are remembered
constexpr auto kWithoutFiles = 10ms;  // pause when the system gives no socket, as when there are too many open files

asio::ip::address loopbackOf(const asio::ip::address& any) {
  return any.is_v6() ? asio::ip::address(asio::ip::address_v6::loopback())
                     : asio::ip::address(asio::ip::address_v4::loopback());
}

/// The first address of this machine that others can reach. An IPv4 address, which also reaches listeners on "::".
std::optional<asio::ip::address> addressForOthers() {
  const std::optional<std::uint32_t> host = hostForOthers();
  return host ? std::optional<asio::ip::address>(asio::ip::address_v4(*host)) : std::nullopt;
}

/// Raises the limit of open files if the system allows it, and returns it. At least twice
/// kFilesOfOthers is reported: with less, connections are dropped when files run out.
std::size_t filesForAll() {
  return std::max<std::size_t>(2 * kFilesOfOthers, std::min(raiseFileLimit(kFilesForAll), kFilesForAll));
}

}  // namespace

void validate(const WebServerOptions& options) {
  if (!addressOf(options)) {
    throw InvalidParameter("bind", options.bind, "an address such as 127.0.0.1, ::1 or 0.0.0.0");
  }
  const std::vector<Entrance>& all = options.entrances;
  const bool open = std::ranges::any_of(all, [](const Entrance& one) { return one.token.empty(); });
  if (open && !isLoopback(options.bind)) {
    throw InvalidParameter("bind", options.bind, "a loopback address unless there is a token");
  }
  for (auto one = all.begin(); one != all.end(); ++one) {
    if (open && all.size() > 1) {
      throw InvalidParameter("token", "missing", "given for each of several entrances");
    }
    if (std::ranges::find(all.begin(), one, one->token, &Entrance::token) != one) {
      throw InvalidParameter("token", "repeated", "different for each entrance");
    }
  }
}

WebServer::Implementation::Implementation(const WebServerOptions& options, Board& shared_board)
    : board(shared_board),
      entrances(options.entrances),
      guessable(options.guessable),
      takes_uploads(options.takes_uploads),
      loopback_only(isLoopback(options.bind)) {
  validate(options);
  const beast::error_code error = listenAsAsked(acceptor, options);
  if (error) {
    throw Failure(fmt::format("cannot listen on {}, port {}: {}", options.bind, options.port,
                              error == asio::error::address_in_use ? "Address already in use" : error.message()));
  }
  const std::size_t files = filesForAll() - kFilesOfOthers;
  most_served = std::min(options.most_served, files / 4);
  most_asking = std::min(options.most_asking, files / 2);
  accept();
  thread = startThread("the web server", [this] { serve(); });
}

WebServer::Implementation::~Implementation() {
  io.stop();
  thread.join();
  ends = true;
}

/// An exception in a handler ends its connection, because no operation is pending on it any more; the
/// program continues.
void WebServer::Implementation::serve() noexcept {
  while (!io.stopped()) {
    try {
      if (!accepting) {
        accept();
      }
      io.run();
    } catch (const std::exception&) {
      continue;
    }
  }
}

void WebServer::Implementation::accept() {
  acceptor.async_accept([this](beast::error_code error, Tcp::socket socket) {
    accepting = false;
    if (error == asio::error::operation_aborted) {
      return;
    }
    if (!error) {
      accept();
      admit(std::move(socket));
      return;
    }
    // There is no file descriptor for a socket, and asking again at once would take a whole core.
    for (const std::size_t left = asking.size / 2; asking.size > left;) {
      sendAwayOneOf(asking);
    }
    pause.expires_after(kWithoutFiles);
    pause.async_wait([this](beast::error_code stopped) {
      accepting = false;
      if (!stopped) {
        accept();
      }
    });
    accepting = true;
  });
  accepting = true;
}

/// A newcomer always gets in: connections that ask for nothing, and those that stay for a next request, are as many as
/// they may be at most, and one of them goes then. Clients with a WebSocket are counted apart.
void WebServer::Implementation::admit(Tcp::socket socket) {
  if (asking.size >= most_asking) {
    sendAwayOneOf(asking);
  }
  beast::error_code ignored;
  socket.set_option(Tcp::no_delay(true), ignored);
  std::make_shared<Visitor>(*this, std::move(socket))->read();
}

/// The one who has been there longest of the network that most come from: who crowds out others crowds out themselves.
void WebServer::Implementation::sendAwayOneOf(Crowd& crowd) {
  const auto most = std::ranges::max_element(crowd.from, {}, [](const auto& here) { return here.second.size(); });
  if (most != crowd.from.end()) {
    most->second.front()->sendAway();
  }
}

bool WebServer::Implementation::mayGuess(const std::string& network, bool wrong) {
  if (!guessable) {
    return true;
  }
  const auto now = std::chrono::steady_clock::now();
  const auto left_of = [now](const Guesses& some) {
    return std::min(kMostGuesses, some.left + kGuessesPerS * std::chrono::duration<double>(now - some.at).count());
  };
  if (guesses.size() >= kMostGuessing && !guesses.contains(network)) {
    std::erase_if(guesses, [&](const auto& some) { return left_of(some.second) >= kMostGuesses; });
    if (guesses.size() >= kMostGuessing) {
      return false;
    }
  }
  Guesses& some = guesses[network];
  some = {left_of(some), now};
  if (some.left < 1) {
    return false;  // otherwise the answer would reveal a correct one
  }
  some.left -= wrong ? 1 : 0;
  return true;
}

std::optional<std::size_t> WebServer::Implementation::entranceOf(std::string_view target) const {
  const std::string_view token = tokenOf(target);
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < entrances.size(); ++i) {  // all of them, so that the duration reveals nothing
    if (entrances[i].token.empty() || sameToken(token, entrances[i].token)) {
      found = i;
    }
  }
  return found;
}

void WebServer::Implementation::join(const std::shared_ptr<Client>& client) {
  clients[last_client] = client;
  joined = clients.size();
}

void WebServer::Implementation::leave(std::uint32_t client) {
  clients.erase(client);
  joined = clients.size();
}

bool WebServer::Implementation::push(Event event) {
  const std::scoped_lock lock(mutex);
  Queue& queue = queues[event.client];
  if (event.kind != Event::Kind::kLeft &&
      (queue.events.size() >= kMostEventsWaiting || queue.bytes + event.text.size() > kMostBytesWaiting)) {
    return false;
  }
  queue.bytes += event.text.size();
  queue.events.push_back(std::move(event));
  return true;
}

/// Clients that have joined are still reported as having left.
void WebServer::Implementation::forget(std::uint32_t client) {
  const std::scoped_lock lock(mutex);
  if (const auto at = queues.find(client); at != queues.end()) {
    std::erase_if(at->second.events, [](const Event& event) { return event.kind == Event::Kind::kMessage; });
    at->second.bytes = 0;
    if (at->second.events.empty()) {
      queues.erase(at);
    }
  }
}

std::uint64_t WebServer::Implementation::keepUpload(std::string bytes) {
  auto kept = std::make_shared<const std::string>(std::move(bytes));
  const std::scoped_lock lock(mutex);
  upload = std::move(kept);
  return ++last_upload;
}

std::string WebServer::Implementation::urlAt(const asio::ip::address& address, std::size_t entrance) const {
  const std::string& token = entrances[entrance].token;
  return fmt::format("http://{}{}{}:{}/{}{}", address.is_v6() ? "[" : "", address.to_string(),
                     address.is_v6() ? "]" : "", acceptor.local_endpoint().port(),
                     token.empty() ? "" : "?token=", token);
}

WebServer::WebServer(const WebServerOptions& options, Board& board)
    : implementation_(std::make_unique<Implementation>(options, board)) {}

WebServer::~WebServer() = default;

std::string WebServer::url(std::size_t entrance) const {
  const asio::ip::address address = implementation_->acceptor.local_endpoint().address();
  return implementation_->urlAt(address.is_unspecified() ? addressForOthers().value_or(loopbackOf(address)) : address,
                                entrance);
}

std::string WebServer::urlHere(std::size_t entrance) const {
  const asio::ip::address address = implementation_->acceptor.local_endpoint().address();
  return implementation_->urlAt(address.is_unspecified() ? loopbackOf(address) : address, entrance);
}

std::uint16_t WebServer::port() const noexcept {
  beast::error_code ignored;
  return implementation_->acceptor.local_endpoint(ignored).port();
}

std::size_t WebServer::clients() const noexcept {
  return implementation_->joined;
}

bool WebServer::takeEvent(Event& event) {
  const std::scoped_lock lock(implementation_->mutex);
  auto& queues = implementation_->queues;
  if (queues.empty()) {
    return false;
  }
  auto next = queues.upper_bound(implementation_->last_taken);  // after who had the last turn
  if (next == queues.end()) {
    next = queues.begin();
  }
  implementation_->last_taken = next->first;
  event = std::move(next->second.events.front());
  next->second.events.pop_front();
  next->second.bytes -= event.text.size();
  if (next->second.events.empty()) {
    queues.erase(next);
  }
  return true;
}

std::shared_ptr<const std::string> WebServer::takeUpload(std::uint64_t number) {
  const std::scoped_lock lock(implementation_->mutex);
  return number == implementation_->last_upload ? std::move(implementation_->upload) : nullptr;
}

void WebServer::notify() {
  if (implementation_->notified.exchange(true)) {
    return;  // it has been notified and has not reacted yet
  }
  asio::post(implementation_->io, [server = implementation_.get()] {
    server->notified = false;
    for (const auto& [number, weak] : std::map(server->clients)) {
      if (const auto client = weak.lock()) {
        client->pump();
      }
    }
  });
}

void WebServer::offer(const std::filesystem::path& file) {
  asio::post(implementation_->io, [server = implementation_.get(), file = std::filesystem::absolute(file)] {
    server->offered[file.filename().string()] = file;
  });
}

void WebServer::send(std::uint32_t client, std::string text) {
  asio::post(implementation_->io, [server = implementation_.get(), client, text = std::move(text)]() mutable {
    const auto at = server->clients.find(client);
    if (at == server->clients.end()) {
      return;
    }
    if (const auto found = at->second.lock()) {
      found->reply(std::move(text));
    }
  });
}

}  // namespace haptolith
