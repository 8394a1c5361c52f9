#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "packets.h"

namespace hand_in_the_loop {

[[nodiscard]] std::int64_t monotonicNs();

/// Answer, and its arrival time at the system's network (monotonic clock).
struct Arrival {
  Answer answer;
  std::int64_t at_ns = 0;
};

/// UDP socket connected to one port of this machine.
class Link {
 public:
  explicit Link(std::uint16_t port);
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  void send(const DevicePacket& packet);
  /// Returns the next received answer, or none.
  [[nodiscard]] std::optional<Arrival> take();
  /// Waits for an answer. @return false after a timeout.
  [[nodiscard]] bool wait(int timeout_ms);

 private:
  int socket_ = -1;
};

/// Returns an unused UDP port.
[[nodiscard]] std::uint16_t freePort();

}  // namespace hand_in_the_loop
