#pragma once

#include <boost/beast/http.hpp>
#include <boost/beast/version.hpp>
#include <fmt/format.h>

#include "haptolith/viewer/web_client.h"
#include "haptolith/viewer/web_files.h"

namespace haptolith {

inline constexpr std::string_view kRecordings = "/recordings/";
inline constexpr std::string_view kUpload = "/upload";
inline constexpr std::size_t kMostClients = 32;
inline constexpr std::size_t kLargestHeader = 8192;  // bytes
inline constexpr auto kRequestTime = 10s;            // for each further one, and to take an answer
inline constexpr auto kUploadTime = 60s;             // for the whole of it, kRequestTime for each piece
inline constexpr auto kFarewellTime = 1s;

inline std::string_view contentType(std::string_view path) {
  constexpr std::pair<std::string_view, std::string_view> kTypes[] = {{".html", "text/html; charset=utf-8"},
                                                                      {".js", "text/javascript; charset=utf-8"},
                                                                      {".css", "text/css; charset=utf-8"},
                                                                      {".svg", "image/svg+xml"},
                                                                      {".png", "image/png"},
                                                                      {".json", "application/json"},
                                                                      {".txt", "text/plain; charset=utf-8"},
                                                                      {".woff2", "font/woff2"}};
  for (const auto& [ending, type] : kTypes) {
    if (path.ends_with(ending)) {
      return type;
    }
  }
  return "application/octet-stream";
}

/// Network of a client, the part that it cannot choose: an IPv6 network gives each host 2^64 addresses.
inline std::string networkOf(const Tcp::socket& socket) {
  beast::error_code ignored;
  const asio::ip::address address = socket.remote_endpoint(ignored).address();
  if (!address.is_v6() || address.to_v6().is_v4_mapped()) {
    return address.to_string();
  }
  const auto bytes = address.to_v6().to_bytes();
  return {bytes.begin(), bytes.begin() + 8};
}

/// Whether one of the subprotocols that are asked for, with commas between them, is ours.
inline bool speaksOurs(const http::fields& request) {
  const auto [first, last] = request.equal_range(http::field::sec_websocket_protocol);
  return std::any_of(first, last, [](const auto& line) {
    const http::token_list asked(line.value());
    return std::any_of(asked.begin(), asked.end(), [](beast::string_view one) { return view(one) == kSubprotocol; });
  });
}

inline const WebFile* findFile(std::string_view target) {
  std::string_view path = target.substr(0, target.find('?'));
  if (path == "/") {
    path = "/index.html";
  }
  const auto files = webFiles();
  const auto file = std::ranges::find(files, path, &WebFile::path);
  return file == files.end() ? nullptr : &*file;
}

/// A connection that is not a WebSocket: requests files. Idle connections are dropped when the limit is reached: see
/// admit().
class WebServer::Implementation::Visitor : public std::enable_shared_from_this<Visitor> {
 public:
  Visitor(Implementation& server, Tcp::socket socket)
      : server_(server), network_(networkOf(socket)), stream_(std::move(socket)) {
    stand(server_.asking);
  }
  ~Visitor() {
    leaveCrowd();
    endUpload();
  }
  Visitor(const Visitor&) = delete;
  Visitor& operator=(const Visitor&) = delete;

  void read() {
    parser_.emplace();
    parser_->header_limit(kLargestHeader);
    parser_->body_limit(kLargestUpload);
    stream_.expires_after(crowd_ == &server_.asking ? kHeaderTime : kRequestTime);
    http::async_read_header(stream_, buffer_, *parser_, [self = shared_from_this()](auto error, std::size_t) {
      if (!self->stream_.socket().is_open() || self->crowd_ == nullptr) {
        return;
      }
      if (!error) {
        self->stand(self->server_.served);
        self->answer();
      } else {
        self->refuseFor(error);
      }
    });
  }

  void sendAway() {
    leaveCrowd();
    endUpload();
    stream_.close();
  }

 private:
  /// Answers what is no HTTP request, or too long a one; what has only broken off gets no answer.
  void refuseFor(beast::error_code error) {
    if (error.category() != http::make_error_code(http::error::bad_method).category() ||
        error == http::error::end_of_stream || error == http::error::partial_message) {
      return;
    }
    stand(server_.served);
    refuse(error == http::error::header_limit ? http::status::request_header_fields_too_large
           : error == http::error::body_limit ? http::status::payload_too_large
                                              : http::status::bad_request,
           error == http::error::body_limit ? fmt::format("larger than {} bytes\n", kLargestUpload)
                                            : "malformed request\n");
  }

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
    const bool is_upload = server_.takes_uploads && path == kUpload;
    const bool needs_token = is_socket || path == "/ws" || is_recording || is_upload;
    if (request.count(http::field::host) > 1 || request.count(http::field::origin) > 1) {
      refuse(http::status::bad_request, "Host and Origin can be given only once\n");
    } else if (!server_.isHostAllowed(host)) {
      refuse(http::status::forbidden,
             "this program accepts only localhost and 127.0.0.1; start it with --bind to use another name\n");
    } else if ((is_socket || is_upload) && !origin.empty() && !isFromHere(origin, host)) {
      refuse(http::status::forbidden, "pages from other origins cannot connect\n");
    } else if (needs_token && !server_.mayGuess(network_, !entrance && !tokenOf(target).empty())) {
      refuse(http::status::too_many_requests, "too many wrong tokens: try again later\n");
    } else if (needs_token && !entrance) {
      refuse(http::status::unauthorized, "the address lacks the token that the program printed\n");
    } else if (is_upload && request.method() == http::verb::put) {
      takeUpload(*entrance);
    } else if (!parser_->is_done()) {
      refuse(http::status::bad_request, "only uploads have a body\n");
    } else if (is_socket) {
      upgrade(path, *entrance);
    } else if (request.method() != http::verb::get && request.method() != http::verb::head) {
      refuse(http::status::method_not_allowed, "only GET and HEAD\n");
    } else if (path == "/ws") {
      refuse(http::status::upgrade_required, "this is a WebSocket\n");
    } else if (is_recording) {
      sendRecording(path.substr(kRecordings.size()), *entrance);
    } else if (const WebFile* file = findFile(target)) {
      send(http::status::ok, contentType(file->path), std::string_view(file->content), request.keep_alive());
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
      refuse(http::status::service_unavailable, "32 clients are already connected\n");
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
      refuse(http::status::forbidden, "this token does not allow access to recordings\n");
      return;
    }
    if (at != server_.offered.end()) {
      file.open(at->second.string().c_str(), beast::file_mode::scan, fault);
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

  /// One at a time, so that many cannot take all memory.
  void takeUpload(std::size_t entrance) {
    if (server_.entrances[entrance].nameless) {
      refuse(http::status::forbidden, "this token does not allow uploads\n");
    } else if (server_.uploading) {
      refuse(http::status::service_unavailable, "another client is uploading a file: try again\n");
    } else {
      upload_.emplace(std::move(*parser_));
      upload_until_ = std::chrono::steady_clock::now() + kUploadTime;
      server_.uploading = uploads_ = true;
      takeMoreOfUpload();
    }
  }

  void takeMoreOfUpload() {
    if (upload_->is_done()) {
      const std::uint64_t number = server_.keepUpload(std::move(upload_->get().body()));
      const bool keeps_alive = upload_->get().keep_alive();
      endUpload();
      send(http::status::ok, "application/json", fmt::format("{{\"upload\": {}}}\n", number), keeps_alive);
      return;
    }
    stream_.expires_at(std::min(upload_until_, std::chrono::steady_clock::now() + kRequestTime));
    http::async_read_some(stream_, buffer_, *upload_, [self = shared_from_this()](auto error, std::size_t) {
      if (self->crowd_ == nullptr) {
        return;
      }
      if (!error) {
        self->takeMoreOfUpload();
        return;
      }
      self->endUpload();
      self->refuseFor(error);
    });
  }

  void endUpload() {
    if (std::exchange(uploads_, false)) {
      server_.uploading = false;
    }
  }

  void refuse(http::status status, std::string why) {
    send(status, "text/plain; charset=utf-8", std::move(why), false);
  }

  void send(http::status status, std::string_view type, std::string content, bool keep_alive) {
    kept_content_ = std::move(content);
    send(status, type, std::string_view(kept_content_), keep_alive);
  }

  /// @param content  outlives the answer.
  void send(http::status status, std::string_view type, std::string_view content, bool keep_alive) {
    const auto& request = parser_->get();
    response_.emplace(std::piecewise_construct, std::make_tuple(content.data(), content.size()),
                      std::make_tuple(status, request.version() == 10 ? 10U : 11U));
    addFields(*response_, type, keep_alive);
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
  std::optional<http::request_parser<http::string_body>> upload_;
  bool uploads_ = false;
  std::chrono::steady_clock::time_point upload_until_;
  std::string kept_content_;
  using Response = http::response<http::span_body<const char>>;
  std::optional<Response> response_;
  std::optional<http::response_serializer<http::span_body<const char>>> serializer_;
  std::optional<http::response<http::file_body>> recording_;
  std::optional<http::response_serializer<http::file_body>> recording_serializer_;
};

}  // namespace haptolith
