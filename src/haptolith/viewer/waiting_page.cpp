#include "haptolith/viewer/waiting_page.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "haptolith/core/platform/start_thread.h"

namespace haptolith {

namespace {

constexpr double kAtRest_m_s = 1e-4;
constexpr int kWaitingPorts = 100;  ///< as WebServer
constexpr int kPatience_ms = 100;

/// Opens a socket that listens on an IPv4 address; -1 on failure.
int listenOn(const std::string& bind_to, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  const std::string name = bind_to == "localhost" ? "127.0.0.1" : bind_to;
  if (inet_pton(AF_INET, name.c_str(), &address.sin_addr) != 1) {
    return -1;
  }
  const int made = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  setsockopt(made, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  // The address of any protocol is passed as the general kind: that is how the system is asked.
  if (made >= 0 &&
      (bind(made, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 || listen(made, SOMAXCONN) != 0)) {
    close(made);
    return -1;
  }
  return made;
}

}  // namespace

double SettledFraction::update(double speed_m_s) noexcept {
  const double speed = std::max(speed_m_s, kAtRest_m_s);
  fastest_m_s_ = std::max(fastest_m_s_, speed);
  const double whole = std::log(fastest_m_s_ / kAtRest_m_s);
  fraction_ = std::max(fraction_, whole > 0 ? std::log(fastest_m_s_ / speed) / whole : 0.0);
  return fraction_;
}

WaitingPage::WaitingPage(const WebServerOptions& options) {
  if (options.port == 0) {
    return;
  }
  for (int i = 0; i < (options.other_ports ? kWaitingPorts : 1) && listener_ < 0; ++i) {
    port_ = static_cast<std::uint16_t>(options.port + i);
    listener_ = listenOn(options.bind, port_);
  }
  if (listener_ < 0) {
    port_ = 0;
    return;
  }
  thread_ = startThread("the page that waits", [this] { serve(); });
}

WaitingPage::~WaitingPage() {
  ends_ = true;
  if (thread_.joinable()) {
    thread_.join();
  }
  if (listener_ >= 0) {
    close(listener_);
  }
}

void WaitingPage::say(std::string sentence) {
  const std::scoped_lock lock(mutex_);
  sentence_ = std::move(sentence);
}

void WaitingPage::serve() {
  while (!ends_) {
    pollfd waits{.fd = listener_, .events = POLLIN, .revents = 0};
    if (poll(&waits, 1, kPatience_ms) <= 0) {
      continue;
    }
    if (const int client = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC); client >= 0) {
      answer(client);
      close(client);
    }
  }
}

void WaitingPage::answer(int client) {
  const timeval patience{.tv_sec = 0, .tv_usec = 1000 * kPatience_ms};
  setsockopt(client, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  setsockopt(client, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  std::array<char, 4096> request{};
  if (recv(client, request.data(), request.size(), 0) <= 0) {
    return;
  }
  std::string sentence;
  {
    const std::scoped_lock lock(mutex_);
    sentence = sentence_;
  }
  const std::string page = fmt::format(
      "<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>"
      "<title>haptolith: {0}</title><body style='font:18px system-ui;background:#0d1216;color:#e3eaef;"
      "display:grid;place-items:center;height:90vh'><p role=status>{0}</p>",
      sentence);
  const std::string response = fmt::format(
      "HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/html\r\nContent-Length: {}\r\nRefresh: 1\r\n"
      "Retry-After: 1\r\nCache-Control: no-store\r\nContent-Security-Policy: default-src 'none'; style-src "
      "'unsafe-inline'\r\nConnection: close\r\n\r\n{}",
      page.size(), page);
  std::size_t sent = 0;
  while (sent < response.size()) {
    const ssize_t more = send(client, response.data() + sent, response.size() - sent, MSG_NOSIGNAL);
    if (more <= 0) {
      return;
    }
    sent += static_cast<std::size_t>(more);
  }
  shutdown(client, SHUT_WR);
}

}  // namespace haptolith
