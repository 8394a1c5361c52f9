#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>
#include <sys/socket.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "haptolith/core/vec.h"
#include "haptolith/device/drivers/inverse3_messages.h"

namespace haptolith {

/// A Haply service without hardware, on this machine, with faults to order. One client at a time.
class HaplyService {
 public:
  static constexpr int kNever = 1 << 30;

  /// Devices 049D and 0FFF, and the grip 61A5, as reported by a service of 3.5 or an earlier one.
  static std::string inventory(HaplyDialect dialect) {
    nlohmann::json message = nlohmann::json::parse(state());
    message["inverse3"].push_back({{"device_id", "0FFF"}, {"config", {{"handedness", "left"}}}});
    if (dialect == HaplyDialect::kVector) {
      message["session_id"] = 7;
      message["inverse3"][0]["config"] = {{"type", "inverse3"}, {"basis", {{"permutation", "XYZ"}}}};
    }
    return message.dump();
  }

  static std::string state(const std::string& x = "0.01") {
    return R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":{"x":)" + x +
           R"(,"y":-0.12,"z":0.15},"cursor_velocity":{"x":0,"y":0.2,"z":-0.3}}}],"wireless_verse_grip":[{"device_id":)"
           R"("61A5","state":{"orientation":{"w":0.5,"x":-0.5,"y":0.5,"z":-0.5},"buttons":{"a":true,"b":false,"c":true}}}]})";
  }

  struct Behaviour {
    HaplyDialect dialect = HaplyDialect::kVector;
    std::string inventory = HaplyService::inventory(HaplyDialect::kVector);
    bool shakes_hands = true;
    bool begins = true;         ///< with its inventory
    int closes_after = kNever;  ///< number of commands
    int silent_after = kNever;
    int answers_each = 1;                                                  ///< messages per command
    std::function<std::string(int)> answer = [](int) { return state(); };  ///< to the n-th command, from 1
  };

  explicit HaplyService(Behaviour behaviour) : behaviour_(std::move(behaviour)), thread_([this] { serve(); }) {}
  ~HaplyService() {
    stopping_ = true;
    shutdown(acceptor_.native_handle(), SHUT_RDWR);
    shutdown(client_.load(), SHUT_RDWR);
    thread_.join();
  }
  HaplyService(const HaplyService&) = delete;
  HaplyService& operator=(const HaplyService&) = delete;

  [[nodiscard]] std::string address() const {
    return "ws://127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port());
  }
  [[nodiscard]] int commands() const { return commands_; }
  /// Commands that it did not understand.
  [[nodiscard]] int misunderstood() const { return misunderstood_; }
  [[nodiscard]] Vec3 force() const {
    const std::lock_guard lock(mutex_);
    return force_n_;
  }

 private:
  using Stream = boost::beast::websocket::stream<boost::asio::ip::tcp::socket>;

  void serve() {
    while (!stopping_) {
      boost::beast::error_code error;
      Stream stream(io_);
      acceptor_.accept(stream.next_layer(), error);
      if (error) {
        return;
      }
      client_ = stream.next_layer().native_handle();
      if (!stopping_) {
        talk(stream);
      }
      client_ = -1;
    }
  }

  void talk(Stream& stream) {
    boost::beast::error_code error;
    boost::beast::flat_buffer buffer;
    if (!behaviour_.shakes_hands) {
      char byte = 0;
      while (stream.next_layer().read_some(boost::asio::buffer(&byte, 1), error) != 0) {
      }
      return;
    }
    stream.accept(error);
    if (!error && behaviour_.begins) {
      stream.write(boost::asio::buffer(behaviour_.inventory), error);
    }
    while (!error) {
      stream.read(buffer, error);
      if (error) {
        return;
      }
      take(boost::beast::buffers_to_string(buffer.data()));
      buffer.consume(buffer.size());
      if (commands_ >= behaviour_.closes_after) {
        stream.close(boost::beast::websocket::close_code::going_away, error);
        return;
      }
      for (int i = 0; i < behaviour_.answers_each && commands_ < behaviour_.silent_after && !error; ++i) {
        stream.write(boost::asio::buffer(behaviour_.answer(commands_)), error);
      }
    }
  }

  void take(const std::string& text) {
    const char* key = behaviour_.dialect == HaplyDialect::kVector ? "vector" : "values";
    try {
      const auto message = nlohmann::json::parse(text);
      const auto& entry = message.at("inverse3").at(0);
      const auto& force = entry.at("commands").at("set_cursor_force").at(key);
      if (message.size() != 1 || message["inverse3"].size() != 1 || entry.at("device_id") != "049D") {
        ++misunderstood_;
      }
      const std::lock_guard lock(mutex_);
      force_n_ = Vec3(force.at("x"), force.at("y"), force.at("z"));
    } catch (const nlohmann::json::exception&) {
      ++misunderstood_;
    }
    ++commands_;
  }

  Behaviour behaviour_;
  boost::asio::io_context io_;
  boost::asio::ip::tcp::acceptor acceptor_{io_, {boost::asio::ip::make_address("127.0.0.1"), 0}};
  std::atomic<int> client_{-1}, commands_{0}, misunderstood_{0};
  std::atomic<bool> stopping_{false};
  mutable std::mutex mutex_;
  Vec3 force_n_ = Vec3::Zero();
  std::thread thread_;
};

}  // namespace haptolith
