#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "haptolith/teleop/link/link.h"

namespace haptolith {

/// A socket for datagrams that never waits. Not for the tick.
class UdpPort {
 public:
  /// Listens at HOST:PORT, port 0: any. @param key  name in messages. @throws InvalidParameter for a malformed
  /// address; Failure when it cannot listen there.
  UdpPort(const char* key, std::string_view listen);
  ~UdpPort();

  struct Datagram {
    std::string from;  ///< HOST:PORT
    Packet bytes;
  };
  /// The next that has come; none: no other has.
  [[nodiscard]] std::optional<Datagram> receive();
  /// Sends without confirmation. @throws InvalidParameter for a malformed address.
  void send(std::string_view to, const Packet& bytes);

  [[nodiscard]] std::uint16_t port() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace haptolith
