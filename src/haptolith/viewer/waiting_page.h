#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "haptolith/viewer/web_server.h"

namespace haptolith {

/// Fraction of settling that is done, 0 to 1, estimated from the speed of the fastest particle: its logarithm falls
/// about evenly from the fastest so far to rest. Never decreases.
class SettledFraction {
 public:
  double update(double speed_m_s) noexcept;

 private:
  double fastest_m_s_ = 0, fraction_ = 0;
};

/// Serves one sentence at the page's address before there is a session to show: "soil settles, 40 % done". The browser
/// reloads it each second, and so opens the page once LiveView has the port. It reads no request and grants nothing.
class WaitingPage {
 public:
  /// Listens where a WebServer of these options would; where it cannot, and with any port (0), it serves nothing.
  explicit WaitingPage(const WebServerOptions& options);
  ~WaitingPage();
  WaitingPage(const WaitingPage&) = delete;
  WaitingPage& operator=(const WaitingPage&) = delete;

  /// 0: it serves nothing.
  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  /// From any thread.
  void say(std::string sentence);

 private:
  class Implementation;

  std::uint16_t port_ = 0;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace haptolith
