#include "haptolith/viewer/web_server.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/version.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <deque>
#include <exception>
#include <filesystem>
#include <iterator>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/start_thread.h"
#include "haptolith/viewer/access.h"
#include "haptolith/viewer/web_files.h"

namespace haptolith {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using namespace std::chrono_literals;

constexpr std::string_view kRecordings = "/recordings/";
constexpr std::string_view kSubprotocol = "haptolith.1";
constexpr std::size_t kMostClients = 32;
constexpr std::size_t kMostLeaving = 16;  // WebSockets that wait for the other side's farewell
constexpr rlim_t kFilesForAll = 4096;
constexpr std::size_t kFilesOfOthers = 256;      // clients, recordings and whatever the rest of the program opens
constexpr std::size_t kLargestMessage = 16384;   // bytes, from a client: a form with long texts
constexpr std::size_t kLargestHeader = 8192;     // bytes
constexpr std::size_t kMostMessagesPerS = 250;   // from a client
constexpr std::size_t kMostBytesPerS = 131'072;  // from a client: eight of the largest messages, or 250 of usual ones
constexpr std::size_t kMostBytesWaiting = 131'072;  // of a client
constexpr std::size_t kMostEventsWaiting = 2048;    // of a client
constexpr std::size_t kMostRepliesWaiting = 64;     // to a client
constexpr double kMostGuesses = 20;  // wrong tokens at once, from a network; a page that comes back with an old one
constexpr double kGuessesPerS = 1;   // after that
constexpr std::size_t kMostGuessing = 1024;  // networks that are remembered
constexpr int kPortsTried = 100;
constexpr auto kHeaderTime = 3s;    // for the first request
constexpr auto kRequestTime = 10s;  // for each further one, and to take an answer
constexpr auto kFarewellTime = 1s;
constexpr auto kWithoutFiles = 10ms;  // pause when the system gives no socket, as when there are too many open files
constexpr auto kIdleTime = 20s;       // half of it passes before a ping

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}
beast::string_view view(std::string_view text) {
  return {text.data(), text.size()};
}

std::string_view contentType(std::string_view path) {
  constexpr std::pair<std::string_view, std::string_view> kTypes[] = {{".html", "text/html; charset=utf-8"},
                                                                      {".js", "text/javascript; charset=utf-8"},
                                                                      {".css", "text/css; charset=utf-8"},
                                                                      {".svg", "image/svg+xml"},
                                                                      {".png", "image/png"},
                                                                      {".json", "application/json"},
                                                                      {".woff2", "font/woff2"}};
  for (const auto& [ending, type] : kTypes) {
    if (path.ends_with(ending)) {
      return type;
    }
  }
  return "application/octet-stream";
}

std::optional<asio::ip::address> addressOf(const WebServerOptions& options) {
  beast::error_code error;
  const auto address = asio::ip::make_address(options.bind == "localhost" ? "127.0.0.1" : options.bind, error);
  return error ? std::nullopt : std::optional(address);
}

asio::ip::address loopbackOf(const asio::ip::address& any) {
  return any.is_v6() ? asio::ip::address(asio::ip::address_v6::loopback())
                     : asio::ip::address(asio::ip::address_v4::loopback());
}

/// The first address of this machine that is not its own alone. Of version 4, which also reaches who listens on "::".
std::optional<asio::ip::address> addressForOthers() {
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) {
    return std::nullopt;
  }
  std::optional<asio::ip::address> found;
  for (const ifaddrs* one = all; one != nullptr && !found; one = one->ifa_next) {
    const bool usable = one->ifa_addr != nullptr && one->ifa_addr->sa_family == AF_INET &&
                        (one->ifa_flags & IFF_UP) != 0 && (one->ifa_flags & IFF_LOOPBACK) == 0;
    if (usable) {
      sockaddr_in address{};
      std::memcpy(&address, one->ifa_addr, sizeof address);
      found = asio::ip::address_v4(ntohl(address.sin_addr.s_addr));
    }
  }
  freeifaddrs(all);
  return found;
}

/// Where somebody is, as far as they cannot choose it themselves: an IPv6 network gives everybody in it 2^64 addresses.
std::string networkOf(const Tcp::socket& socket) {
  beast::error_code ignored;
  const asio::ip::address address = socket.remote_endpoint(ignored).address();
  if (!address.is_v6() || address.to_v6().is_v4_mapped()) {
    return address.to_string();
  }
  const auto bytes = address.to_v6().to_bytes();
  return {bytes.begin(), bytes.begin() + 8};
}

/// How many files this process may have open; as many as we want where the system lets it. At least twice
/// kFilesOfOthers is said: with less, connections go as files run out.
std::size_t filesForAll() {
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) != 0) {
    return 2 * kFilesOfOthers;
  }
  if (files.rlim_cur < kFilesForAll) {
    const rlimit more{std::min(kFilesForAll, files.rlim_max), files.rlim_max};
    if (more.rlim_cur > files.rlim_cur && setrlimit(RLIMIT_NOFILE, &more) == 0) {
      files = more;
    }
  }
  return std::max<std::size_t>(2 * kFilesOfOthers, std::min(files.rlim_cur, kFilesForAll));
}

/// Whether one of the subprotocols that are asked for, with commas between them, is ours.
bool speaksOurs(const http::fields& request) {
  const auto [first, last] = request.equal_range(http::field::sec_websocket_protocol);
  return std::any_of(first, last, [](const auto& line) {
    const http::token_list asked(line.value());
    return std::any_of(asked.begin(), asked.end(), [](beast::string_view one) { return view(one) == kSubprotocol; });
  });
}

const WebFile* findFile(std::string_view target) {
  std::string_view path = target.substr(0, target.find('?'));
  if (path == "/") {
    path = "/index.html";
  }
  const auto files = webFiles();
  const auto file = std::ranges::find(files, path, &WebFile::path);
  return file == files.end() ? nullptr : &*file;
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
      throw InvalidParameter("token", "left out", "given where there is more than one entrance");
    }
    if (std::ranges::find(all.begin(), one, one->token, &Entrance::token) != one) {
      throw InvalidParameter("token", "the same twice", "another one for each entrance");
    }
  }
}

class WebServer::Implementation {
 public:
  Implementation(const WebServerOptions& options, Board& shared_board);
  ~Implementation();

  class Client;
  class Visitor;

  /// Wrong tokens that a network may still send.
  struct Guesses {
    double left = kMostGuesses;
    std::chrono::steady_clock::time_point at;
  };
  /// Visitors by where they are, of each place the oldest first.
  struct Crowd {
    std::map<std::string, std::list<Visitor*>> from;
    std::size_t size = 0;
  };

  void serve() noexcept;
  void accept();
  void admit(Tcp::socket socket);
  static void sendAwayOneOf(Crowd& crowd);
  /// Whether a network may try a token now; counts one that is wrong.
  [[nodiscard]] bool mayGuess(const std::string& network, bool wrong);
  /// Number of the entrance that a request's token opens.
  [[nodiscard]] std::optional<std::size_t> entranceOf(std::string_view target) const;
  [[nodiscard]] std::string urlAt(const asio::ip::address& address, std::size_t entrance) const;
  [[nodiscard]] bool isHostAllowed(std::string_view host) const { return !loopback_only || namesLoopback(host); }
  void join(const std::shared_ptr<Client>& client);
  void leave(std::uint32_t client);
  bool push(Event event);
  void forget(std::uint32_t client);

  bool ends = false;       // outlives io, which destroys the clients that are left
  bool accepting = false;  ///< or about to, after a pause
  std::size_t most_asking = 0, most_served = 0;
  Crowd asking, served;                                    // of the server's thread, as is what follows
  std::map<std::uint32_t, std::weak_ptr<Client>> clients;  // those that have not ended
  std::size_t sockets_of_clients = 0;
  std::uint32_t last_client = 0;
  std::map<std::string, Guesses> guesses;                             // by network
  std::map<std::string, std::filesystem::path, std::less<>> offered;  // by name

  asio::io_context io{1};  // its end is that of visitors and clients, who use the above
  Tcp::acceptor acceptor{io};
  asio::steady_timer pause{io};
  Board& board;
  std::vector<Entrance> entrances;
  bool guessable = false;
  bool loopback_only = true;
  std::atomic<std::size_t> joined{0};

  /// What waits of a client.
  struct Queue {
    std::deque<Event> events;
    std::size_t bytes = 0;
  };
  std::mutex mutex;
  std::map<std::uint32_t, Queue> queues;  // none of them empty
  std::uint32_t last_taken = 0;
  std::atomic<bool> notified{false};
  std::thread thread;
};

/// A WebSocket. At most one message is on its way; the next is chosen when that has gone, so a slow client skips
/// pictures.
class WebServer::Implementation::Client : public std::enable_shared_from_this<Client> {
 public:
  Client(Implementation& server, Tcp::socket socket, std::uint32_t number, std::size_t entrance)
      : server_(server), ws_(std::move(socket)), number_(number), entrance_(entrance) {
    seen_.nameless = server_.entrances[entrance].nameless;
    ++server_.sockets_of_clients;
  }
  ~Client() {
    if (!server_.ends) {
      try {
        end();                           // when a handler has thrown, nobody has
      } catch (const std::exception&) {  // no memory to say so
      }
    }
    --server_.sockets_of_clients;
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void start(const http::request<http::empty_body>& request) {
    websocket::stream_base::timeout times{};
    times.handshake_timeout = kHeaderTime;
    times.idle_timeout = kIdleTime;
    times.keep_alive_pings = true;
    ws_.set_option(times);
    ws_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
      response.set(http::field::sec_websocket_protocol, view(kSubprotocol));
    }));
    ws_.read_message_max(kLargestMessage);
    beast::get_lowest_layer(ws_).expires_never();
    ws_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
      if (error) {
        self->end();
        return;
      }
      self->open_ = self->server_.push({Event::Kind::kJoined, self->number_, {}, self->entrance_});
      self->read();
      self->pump();
    });
  }

  /// Sends what there is, unless something is on its way already.
  void pump() {
    if (writing_ || !open_) {
      return;
    }
    if (seen_.hello && !replies_.empty()) {
      on_its_way_ = {std::make_shared<const std::string>(std::move(replies_.front()))};
      replies_.pop_front();
    } else if (std::optional<Board::Message> next = server_.board.next(number_, seen_)) {
      on_its_way_ = *std::move(next);
    } else {
      return;
    }
    writing_ = true;
    ws_.binary(on_its_way_.binary);
    ws_.async_write(asio::buffer(*on_its_way_.bytes),
                    [self = shared_from_this()](beast::error_code error, std::size_t) {
                      self->writing_ = false;
                      if (error) {
                        self->end();
                      } else {
                        self->pump();
                      }
                    });
  }

  void reply(std::string text) {
    if (replies_.size() >= kMostRepliesWaiting) {
      close(websocket::close_code::policy_error);
      return;
    }
    replies_.push_back(std::move(text));
    pump();
  }

  void close(websocket::close_code code) {
    if (!open_) {
      return;
    }
    const bool reads = !writing_;  // one that does not read will not read a farewell either
    end();
    if (reads && server_.sockets_of_clients <= server_.clients.size() + kMostLeaving) {
      writing_ = true;
      ws_.async_close(code, [self = shared_from_this()](beast::error_code) {});
    } else {
      beast::get_lowest_layer(ws_).close();
    }
  }

 private:
  void read() {
    ws_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error || !self->open_) {
        self->end();
        return;
      }
      self->take();
    });
  }

  void take() {
    if (!ws_.got_text()) {
      close(websocket::close_code::unknown_data);
      return;
    }
    if (const auto now = std::chrono::steady_clock::now(); now - second_began_ > 1s) {
      second_began_ = now;
      messages_this_second_ = 0;
      bytes_this_second_ = 0;
    }
    bytes_this_second_ += buffer_.size();
    if (++messages_this_second_ > kMostMessagesPerS || bytes_this_second_ > kMostBytesPerS ||
        !server_.push({Event::Kind::kMessage, number_, beast::buffers_to_string(buffer_.data())})) {
      server_.forget(number_);
      close(websocket::close_code::policy_error);
      return;
    }
    buffer_.consume(buffer_.size());
    read();
  }

  void end() {
    if (std::exchange(open_, false)) {
      server_.push({Event::Kind::kLeft, number_, {}});
    }
    server_.leave(number_);
    if (writing_) {  // else the socket stays for as long as the other side does not read
      beast::get_lowest_layer(ws_).close();
    }
  }

  Implementation& server_;
  websocket::stream<beast::tcp_stream> ws_;
  std::uint32_t number_;
  std::size_t entrance_;
  Board::Seen seen_;
  beast::flat_buffer buffer_;
  std::deque<std::string> replies_;
  Board::Message on_its_way_;
  bool writing_ = false, open_ = false;
  std::chrono::steady_clock::time_point second_began_;
  std::size_t messages_this_second_ = 0, bytes_this_second_ = 0;
};

/// A connection that has not become a WebSocket: asks for files. Who lets others wait is sent away for them: see
/// admit().
class WebServer::Implementation::Visitor : public std::enable_shared_from_this<Visitor> {
 public:
  Visitor(Implementation& server, Tcp::socket socket)
      : server_(server), network_(networkOf(socket)), stream_(std::move(socket)) {
    stand(server_.asking);
  }
  ~Visitor() { leaveCrowd(); }
  Visitor(const Visitor&) = delete;
  Visitor& operator=(const Visitor&) = delete;

  void read() {
    parser_.emplace();
    parser_->header_limit(kLargestHeader);
    parser_->body_limit(0);
    stream_.expires_after(crowd_ == &server_.asking ? kHeaderTime : kRequestTime);
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (!self->stream_.socket().is_open() || self->crowd_ == nullptr) {
        return;
      }
      if (!error) {
        self->stand(self->server_.served);
        self->answer();
      } else if (error.category() == http::make_error_code(http::error::bad_method).category() &&
                 error != http::error::end_of_stream && error != http::error::partial_message) {
        self->stand(self->server_.served);
        self->refuse(error == http::error::header_limit ? http::status::request_header_fields_too_large
                                                        : http::status::bad_request,
                     "this is no request that the program understands\n");
      }
    });
  }

  void sendAway() {
    leaveCrowd();
    stream_.close();
  }

 private:
  void stand(Crowd& crowd) {
    if (crowd_ == &crowd) {
      return;
    }
    if (&crowd == &server_.served && crowd.size >= server_.most_served) {
      sendAwayOneOf(crowd);
    }
    leaveCrowd();
    std::list<Visitor*>& here = crowd.from[network_];
    place_ = here.insert(here.end(), this);
    ++crowd.size;
    crowd_ = &crowd;
  }
  void leaveCrowd() {
    if (Crowd* crowd = std::exchange(crowd_, nullptr)) {
      const auto here = crowd->from.find(network_);
      here->second.erase(place_);
      if (here->second.empty()) {
        crowd->from.erase(here);
      }
      --crowd->size;
    }
  }

  void answer() {
    const auto& request = parser_->get();
    const std::string_view target = view(request.target());
    const std::string_view host = view(request[http::field::host]);
    const std::string_view origin = view(request[http::field::origin]);
    const bool is_socket = websocket::is_upgrade(request);
    const std::string_view path = target.substr(0, target.find('?'));
    const std::optional<std::size_t> entrance = server_.entranceOf(target);
    const bool is_recording = path.starts_with(kRecordings);
    const bool needs_token = is_socket || path == "/ws" || is_recording;
    if (request.count(http::field::host) > 1 || request.count(http::field::origin) > 1) {
      refuse(http::status::bad_request, "Host and Origin may be given once only\n");
    } else if (!server_.isHostAllowed(host)) {
      refuse(http::status::forbidden, "this address is not one of the program's\n");
    } else if (is_socket && !origin.empty() && !isFromHere(origin, host)) {
      refuse(http::status::forbidden, "pages from elsewhere may not connect\n");
    } else if (needs_token && !server_.mayGuess(network_, !entrance && !tokenOf(target).empty())) {
      refuse(http::status::too_many_requests, "too many wrong tokens: try again in a while\n");
    } else if (needs_token && !entrance) {
      refuse(http::status::unauthorized, "the address lacks the token that the program printed\n");
    } else if (is_socket) {
      upgrade(path, *entrance);
    } else if (request.method() != http::verb::get && request.method() != http::verb::head) {
      refuse(http::status::method_not_allowed, "only GET and HEAD\n");
    } else if (path == "/ws") {
      refuse(http::status::upgrade_required, "this is a WebSocket\n");
    } else if (is_recording) {
      sendRecording(path.substr(kRecordings.size()), *entrance);
    } else if (const WebFile* file = findFile(target)) {
      send(http::status::ok, contentType(file->path), file->content);
    } else {
      refuse(http::status::not_found, "there is no such file\n");
    }
  }

  void upgrade(std::string_view path, std::size_t entrance) {
    const auto& request = parser_->get();
    if (path != "/ws") {
      refuse(http::status::not_found, "the WebSocket is /ws\n");
    } else if (!speaksOurs(request)) {
      refuse(http::status::bad_request, "the WebSocket speaks haptolith.1\n");
    } else if (server_.joined >= kMostClients) {
      refuse(http::status::service_unavailable, "32 clients look on already\n");
    } else {
      leaveCrowd();
      const auto client = std::make_shared<Client>(server_, stream_.release_socket(), ++server_.last_client, entrance);
      server_.join(client);
      client->start(request);
    }
  }

  /// Only what has been offered, by its very name: a path leads nowhere else.
  void sendRecording(std::string_view name, std::size_t entrance) {
    const auto at = server_.offered.find(name);
    beast::error_code fault;
    http::file_body::value_type file;
    if (server_.entrances[entrance].nameless) {
      refuse(http::status::forbidden, "this token opens no recordings\n");
      return;
    }
    if (at != server_.offered.end()) {
      file.open(at->second.c_str(), beast::file_mode::scan, fault);
    }
    if (at == server_.offered.end() || fault) {
      refuse(http::status::not_found, "there is no such recording\n");
      return;
    }
    recording_.emplace(std::piecewise_construct, std::make_tuple(std::move(file)),
                       std::make_tuple(http::status::ok, parser_->get().version() == 10 ? 10U : 11U));
    addFields(*recording_, "application/x-hdf5", parser_->get().keep_alive());
    recording_->set(http::field::content_disposition, fmt::format("attachment; filename=\"{}\"", name));
    recording_->prepare_payload();
    recording_serializer_.emplace(*recording_);
    if (parser_->get().method() == http::verb::head) {
      http::async_write_header(stream_, *recording_serializer_, [self = shared_from_this()](auto error, std::size_t) {
        self->sent(error, self->recording_->keep_alive());
      });
    } else {
      sendMoreOfRecording();
    }
  }

  /// Each piece has its own time: a recording of an hour is 0.8 GB.
  void sendMoreOfRecording() {
    stream_.expires_after(kRequestTime);
    http::async_write_some(stream_, *recording_serializer_, [self = shared_from_this()](auto error, std::size_t) {
      if (error || self->recording_serializer_->is_done()) {
        self->sent(error, self->recording_->keep_alive());
      } else if (self->crowd_ != nullptr) {
        self->sendMoreOfRecording();
      }
    });
  }

  void refuse(http::status status, std::string_view why) { send(status, "text/plain; charset=utf-8", why); }

  void send(http::status status, std::string_view type, std::string_view content) {
    const auto& request = parser_->get();
    response_.emplace(std::piecewise_construct, std::make_tuple(content.data(), content.size()),
                      std::make_tuple(status, request.version() == 10 ? 10U : 11U));
    addFields(*response_, type, status == http::status::ok && request.keep_alive());
    response_->prepare_payload();
    const auto done = [self = shared_from_this()](beast::error_code error, std::size_t) {
      self->sent(error, self->response_->keep_alive());
    };
    if (request.method() == http::verb::head) {
      serializer_.emplace(*response_);
      http::async_write_header(stream_, *serializer_, done);
    } else {
      http::async_write(stream_, *response_, done);
    }
  }

  static void addFields(auto& response, std::string_view type, bool keep_alive) {
    response.set(http::field::server, "haptolith");
    response.set(http::field::content_type, view(type));
    response.set(http::field::cache_control, "no-store");
    response.set("Content-Security-Policy",
                 "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
                 "connect-src 'self'; frame-ancestors 'self'; base-uri 'none'");
    response.set("X-Content-Type-Options", "nosniff");
    response.set("Referrer-Policy", "no-referrer");  // the address may hold the token
    response.keep_alive(keep_alive);
  }

  void sent(beast::error_code error, bool keep_alive) {
    recording_serializer_.reset();
    recording_.reset();
    if (!error && keep_alive) {
      read();
    } else if (!error) {
      hangUp();
    }
  }

  /// Ends when the other side does, or soon: to close a socket with something unread in it takes the answer back.
  void hangUp() {
    beast::error_code ignored;
    stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    stream_.expires_after(kFarewellTime);
    takeTheRest();
  }
  void takeTheRest() {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(kLargestHeader),
                            [self = shared_from_this()](beast::error_code error, std::size_t) {
                              if (!error && self->crowd_ != nullptr) {
                                self->takeTheRest();
                              }
                            });
  }

  Implementation& server_;
  std::string network_;
  Crowd* crowd_ = nullptr;  ///< one of the server's; none: sent away, or a client by now
  std::list<Visitor*>::iterator place_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  using Response = http::response<http::span_body<const char>>;
  std::optional<Response> response_;
  std::optional<http::response_serializer<http::span_body<const char>>> serializer_;
  std::optional<http::response<http::file_body>> recording_;
  std::optional<http::response_serializer<http::file_body>> recording_serializer_;
};

WebServer::Implementation::Implementation(const WebServerOptions& options, Board& shared_board)
    : board(shared_board),
      entrances(options.entrances),
      guessable(options.guessable),
      loopback_only(isLoopback(options.bind)) {
  validate(options);
  const asio::ip::address ip = *addressOf(options);
  beast::error_code error;
  const int tried = options.other_ports ? kPortsTried : 1;
  for (int i = 0; i < tried; ++i) {
    const auto port = static_cast<std::uint16_t>(options.port == 0 ? 0 : options.port + i);
    const Tcp::endpoint endpoint(ip, port);
    acceptor = Tcp::acceptor(io);
    acceptor.open(endpoint.protocol(), error);
    if (!error) {
      acceptor.set_option(asio::socket_base::reuse_address(true), error);
      acceptor.bind(endpoint, error);
    }
    if (!error) {
      acceptor.listen(asio::socket_base::max_listen_connections, error);
    }
    if (!error || error != asio::error::address_in_use || port == 65535) {
      break;
    }
  }
  if (error) {
    throw Failure(fmt::format("cannot listen on {}, port {}: {}", options.bind, options.port, error.message()));
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

/// An exception in a handler ends the connection that it was for, since nobody waits for anything on it any more; the
/// program goes on.
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
    return false;  // a right one would tell that it is
  }
  some.left -= wrong ? 1 : 0;
  return true;
}

std::optional<std::size_t> WebServer::Implementation::entranceOf(std::string_view target) const {
  const std::string_view token = tokenOf(target);
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < entrances.size(); ++i) {  // all of them, so that the time it takes tells nothing
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

void WebServer::notify() {
  if (implementation_->notified.exchange(true)) {
    return;  // it has been told and has not come to it
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
