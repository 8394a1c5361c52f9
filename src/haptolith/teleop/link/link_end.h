#pragma once

#include <cstdint>
#include <string>

#include "haptolith/teleop/link/teleop_packet.h"

namespace haptolith {

/// Packets that came, and what became of them.
struct PacketCounts {
  std::uint64_t taken = 0;
  std::uint64_t malformed = 0;
  std::string first_malformed = {};  ///< why the first was not read
  std::uint64_t forged = 0;          ///< do not prove that their sender knows the key
  std::uint64_t greetings = 0;       ///< from senders that do not know this end's nonce yet
  std::uint64_t replayed = 0;        ///< older than another, or of a connection that is over
  std::uint64_t strangers = 0;       ///< from other senders during a connection

  [[nodiscard]] bool operator==(const PacketCounts&) const = default;
};

/// Addresses of either end of a link, and its trusted senders.
struct EndOptions {
  std::string listen = "127.0.0.1:7410";
  std::string key;        ///< 64 hexadecimal digits; empty: packets are not signed
  bool insecure = false;  ///< without a key also beyond this machine
  Sending sending;
};

/// A number to call a connection by: drawn, never 0.
[[nodiscard]] std::uint32_t newConnection();

/// @param key, address  source or target of packets. @throws InvalidParameter for a malformed address, and for one
/// beyond this machine while packets are unsigned without explicit consent.
void requireSafe(const char* key, const std::string& address, const EndOptions& options);

}  // namespace haptolith
