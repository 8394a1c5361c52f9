#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "packets.h"

namespace hand_in_the_loop {

[[nodiscard]] std::int64_t monotonicNs();

/// An answer, and when the system's network took it in (monotonic clock).
struct Arrival {
  Answer answer;
  std::int64_t at_ns = 0;
};

/// A UDP socket that talks to one port of this machine.
class Link {
 public:
  explicit Link(std::uint16_t port);
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  void send(const DevicePacket& packet);
  /// What has come and not been taken yet; nothing, when there is nothing.
  [[nodiscard]] std::optional<Arrival> take();
  /// Waits for something to take; false: none within that time.
  [[nodiscard]] bool wait(int timeout_ms);

 private:
  int socket_ = -1;
};

/// A UDP port that nobody uses at the moment.
[[nodiscard]] std::uint16_t freePort();

}  // namespace hand_in_the_loop
