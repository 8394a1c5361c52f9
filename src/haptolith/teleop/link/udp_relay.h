#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "haptolith/teleop/link/link.h"
#include "haptolith/teleop/link/link_profiles.h"

namespace haptolith {

struct UdpRelayOptions {
  std::string listen = "127.0.0.1:7400";  ///< address for the operator's program: HOST:PORT; port 0: any
  std::string to;                         ///< address of the robot's program: HOST:PORT
};

/// A link between two programs that talk by UDP, in real time: packets of the first reach the second late or
/// not at all, and back. The first is the first sender, until it has been silent for ten seconds; other senders are
/// ignored, but identities are not verified: packets must prove that themselves. Datagrams pass unread. Not for the
/// tick.
class UdpRelay {
 public:
  /// Listens. @throws InvalidParameter for a malformed address, and as Link; Failure when it cannot listen there.
  UdpRelay(const LinkParameters& up, const LinkParameters& down, const UdpRelayOptions& options);
  ~UdpRelay();

  /// Relays packets for this duration. @throws Failure when the system accepts no more.
  void run(double duration_s);

  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] const LinkCounts& up() const noexcept;
  [[nodiscard]] const LinkCounts& down() const noexcept;
  /// Packets that were not taken: of strangers, for a first one that there is not yet, or while 64 MiB are on their
  /// way.
  [[nodiscard]] std::uint64_t ignored() const noexcept;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace haptolith
