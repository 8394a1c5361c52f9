#include "haptolith/viewer/waiting_page.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>
#include <utility>

#include "haptolith/core/platform/start_thread.h"
#include "haptolith/viewer/web_listener.h"

namespace haptolith {

namespace {

namespace asio = boost::asio;
using Error = boost::system::error_code;

constexpr double kAtRest_m_s = 1e-4;
constexpr std::chrono::milliseconds kPatience{100};

std::string responseThatSays(const std::string& sentence) {
  const std::string page = fmt::format(
      "<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>"
      "<title>haptolith: {0}</title><body style='font:18px system-ui;background:#0d1216;color:#e3eaef;"
      "display:grid;place-items:center;height:90vh'><p role=status>{0}</p>",
      sentence);
  return fmt::format(
      "HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/html\r\nContent-Length: {}\r\nRefresh: 1\r\n"
      "Retry-After: 1\r\nCache-Control: no-store\r\nContent-Security-Policy: default-src 'none'; style-src "
      "'unsafe-inline'\r\nConnection: close\r\n\r\n{}",
      page.size(), page);
}

/// One request and its answer; closed when they take too long.
struct Visit : std::enable_shared_from_this<Visit> {
  explicit Visit(asio::ip::tcp::socket from) : socket(std::move(from)), patience(socket.get_executor(), kPatience) {}

  void answer(std::string with) {
    response = std::move(with);
    patience.async_wait([self = shared_from_this()](Error stopped) {
      if (!stopped) {
        Error ignored;
        self->socket.close(ignored);
      }
    });
    socket.async_read_some(asio::buffer(request), [self = shared_from_this()](Error error, std::size_t /*bytes*/) {
      if (!error) {
        self->write();
      }
    });
  }

  void write() {
    asio::async_write(socket, asio::buffer(response), [self = shared_from_this()](Error, std::size_t /*bytes*/) {
      Error ignored;
      self->socket.shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
      self->patience.cancel();
    });
  }

  asio::ip::tcp::socket socket;
  asio::steady_timer patience;
  std::array<char, 4096> request{};
  std::string response;
};

}  // namespace

double SettledFraction::update(double speed_m_s) noexcept {
  const double speed = std::max(speed_m_s, kAtRest_m_s);
  fastest_m_s_ = std::max(fastest_m_s_, speed);
  const double whole = std::log(fastest_m_s_ / kAtRest_m_s);
  fraction_ = std::max(fraction_, whole > 0 ? std::log(fastest_m_s_ / speed) / whole : 0.0);
  return fraction_;
}

class WaitingPage::Implementation {
 public:
  explicit Implementation(const WebServerOptions& options) {
    if (const Error error = listenAsAsked(acceptor_, options); !error) {
      port_ = acceptor_.local_endpoint().port();
      accept();
      thread_ = startThread("the page that waits", [this] { io_.run(); });
    }
  }
  ~Implementation() {
    io_.stop();
    if (thread_.joinable()) {
      thread_.join();
    }
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }

  void say(std::string sentence) {
    const std::scoped_lock lock(mutex_);
    sentence_ = std::move(sentence);
  }

 private:
  void accept() {
    acceptor_.async_accept([this](Error error, asio::ip::tcp::socket socket) {
      if (!error) {
        std::make_shared<Visit>(std::move(socket))->answer(response());
      }
      pause_.expires_after(error ? kPatience : std::chrono::milliseconds(0));  // as when there are too many open files
      pause_.async_wait([this](Error stopped) {
        if (!stopped) {
          accept();
        }
      });
    });
  }

  std::string response() {
    const std::scoped_lock lock(mutex_);
    return responseThatSays(sentence_);
  }

  asio::io_context io_{1};
  asio::ip::tcp::acceptor acceptor_{io_};
  asio::steady_timer pause_{io_};
  std::uint16_t port_ = 0;
  std::mutex mutex_;
  std::string sentence_ = "soil settles";
  std::thread thread_;
};

WaitingPage::WaitingPage(const WebServerOptions& options) {
  if (options.port != 0) {
    implementation_ = std::make_unique<Implementation>(options);
    port_ = implementation_->port();
  }
}

WaitingPage::~WaitingPage() = default;

void WaitingPage::say(std::string sentence) {
  if (implementation_) {
    implementation_->say(std::move(sentence));
  }
}

}  // namespace haptolith
