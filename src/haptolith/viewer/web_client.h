#pragma once

#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "haptolith/viewer/web_server_implementation.h"

namespace haptolith {

namespace http = beast::http;
namespace websocket = beast::websocket;

inline constexpr std::size_t kMostLeaving = 16;        // WebSockets that wait for the other side's farewell
inline constexpr std::size_t kLargestMessage = 16384;  // bytes, from a client: a form with long texts
inline constexpr std::size_t kMostMessagesPerS = 250;  // from a client
inline constexpr std::size_t kMostBytesPerS =
    131'072;  // from a client: eight of the largest messages, or 250 of usual ones
inline constexpr std::size_t kMostRepliesWaiting = 64;  // to a client
inline constexpr auto kIdleTime = 20s;                  // half of it passes before a ping

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
        end();                           // when a handler has thrown, nothing else ends it
      } catch (const std::exception&) {  // no memory to report it
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

}  // namespace haptolith
