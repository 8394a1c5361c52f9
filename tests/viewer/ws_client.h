#pragma once

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>

#include <chrono>
#include <deque>
#include <optional>
#include <string>
#include <utility>

namespace haptolith {

/// A browser's side of the WebSocket, also with hostile input. Everything ends after ten
/// seconds.
class WsClient {
 public:
  explicit WsClient(std::uint16_t port) : port_(port), stream_(io_) {
    auto& tcp = boost::beast::get_lowest_layer(stream_);
    tcp.expires_after(std::chrono::seconds(10));
    tcp.connect({boost::asio::ip::make_address("127.0.0.1"), port});
    host_ = "127.0.0.1:" + std::to_string(port);
  }

  std::string host_, origin_, target_ = "/ws", protocol_ = "haptolith.1";

  /// Asks for the WebSocket; returns the HTTP status of the answer, 101 when it is one now.
  unsigned upgrade() {
    namespace websocket = boost::beast::websocket;
    boost::beast::get_lowest_layer(stream_).expires_never();
    stream_.set_option(websocket::stream_base::timeout{std::chrono::seconds(10), std::chrono::seconds(10), false});
    stream_.set_option(websocket::stream_base::decorator([this](websocket::request_type& request) {
      if (!origin_.empty()) {
        request.set(boost::beast::http::field::origin, origin_);
      }
      if (!protocol_.empty()) {
        request.set(boost::beast::http::field::sec_websocket_protocol, protocol_);
      }
    }));
    boost::beast::error_code error;
    stream_.handshake(host_, target_, error);
    return error ? refusal() : 101;
  }

  void send(const std::string& text, bool binary = false) {
    stream_.binary(binary);
    boost::beast::error_code error;
    stream_.write(boost::asio::buffer(text), error);
  }

  /// The next message; none when the other side has ended, or takes too long.
  std::optional<std::string> receive() {
    if (std::chrono::steady_clock::now() > end_) {
      return std::nullopt;
    }
    boost::beast::flat_buffer buffer;
    boost::beast::error_code error;
    stream_.read(buffer, error);
    if (error) {
      return std::nullopt;
    }
    return boost::beast::buffers_to_string(buffer.data());
  }
  [[nodiscard]] bool gotText() const { return stream_.got_text(); }

  /// The next text of a type, frames and others left out. But a scene, which is sent once, is kept for later queries
  /// next: it may come before the reply to what has changed it.
  std::optional<nlohmann::json> receive(const std::string& type) {
    if (type == "scene" && !scenes_.empty()) {
      nlohmann::json scene = std::move(scenes_.front());
      scenes_.pop_front();
      return scene;
    }
    while (const std::optional<std::string> message = receive()) {
      if (gotText()) {
        nlohmann::json json = nlohmann::json::parse(*message);
        if (json["type"] == type) {
          return json;
        }
        if (json["type"] == "scene") {
          scenes_.push_back(std::move(json));
        }
      }
    }
    return std::nullopt;
  }

  /// Why the other side ended.
  [[nodiscard]] std::uint16_t closeCode() const { return stream_.reason().code; }

  /// A plain request.
  static std::pair<unsigned, std::string> get(std::uint16_t port, const std::string& target,
                                              const std::string& host = {},
                                              boost::beast::http::verb verb = boost::beast::http::verb::get) {
    namespace http = boost::beast::http;
    http::request<http::empty_body> request(verb, target, 11);
    request.set(http::field::host, host.empty() ? "127.0.0.1:" + std::to_string(port) : host);
    return answerTo(request, port);
  }

  /// A request with a body.
  static std::pair<unsigned, std::string> put(std::uint16_t port, const std::string& target, std::string body,
                                              const std::string& origin = {}) {
    namespace http = boost::beast::http;
    http::request<http::string_body> request(http::verb::put, target, 11, std::move(body));
    request.set(http::field::host, "127.0.0.1:" + std::to_string(port));
    if (!origin.empty()) {
      request.set(http::field::origin, origin);
    }
    request.prepare_payload();
    return answerTo(request, port);
  }

 private:
  /// Repeats the request by hand: the library does not report the reason of a refusal.
  [[nodiscard]] unsigned refusal() const {
    namespace http = boost::beast::http;
    http::request<http::empty_body> request(http::verb::get, target_, 11);
    request.set(http::field::host, host_);
    request.set(http::field::connection, "Upgrade");
    request.set(http::field::upgrade, "websocket");
    request.set(http::field::sec_websocket_version, "13");
    request.set(http::field::sec_websocket_key, "dGhlIHNhbXBsZSBub25jZQ==");
    if (!protocol_.empty()) {
      request.set(http::field::sec_websocket_protocol, protocol_);
    }
    if (!origin_.empty()) {
      request.set(http::field::origin, origin_);
    }
    return answerTo(request, port_).first;
  }

  template <class Body>
  static std::pair<unsigned, std::string> answerTo(const boost::beast::http::request<Body>& request,
                                                   std::uint16_t port) {
    namespace http = boost::beast::http;
    boost::asio::io_context io;
    boost::beast::tcp_stream stream(io);
    stream.expires_after(std::chrono::seconds(10));
    stream.connect({boost::asio::ip::make_address("127.0.0.1"), port});
    boost::beast::error_code refused_early;  // before all of a body was sent
    http::write(stream, request, refused_early);
    boost::beast::flat_buffer buffer;
    http::response_parser<http::string_body> response;
    response.skip(request.method() == http::verb::head);
    http::read(stream, buffer, response);
    return {response.get().result_int(), response.get().body()};
  }

  std::chrono::steady_clock::time_point end_ = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  std::deque<nlohmann::json> scenes_;
  std::uint16_t port_;
  boost::asio::io_context io_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> stream_;
};

}  // namespace haptolith
