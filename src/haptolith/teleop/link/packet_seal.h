#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "haptolith/device/drivers/packet_key.h"
#include "haptolith/teleop/link/link.h"

namespace haptolith {

/// One end of a conversation in which packets prove who sent them, and that they are of now. With a key shared by both
/// ends only, each packet is followed by 32 bytes:
///
///     packet || own nonce (16 bytes) || BLAKE2b(key, the other's nonce || packet || own nonce), 16 bytes
///
/// A nonce is drawn at the start of each end, so that intercepted packets are useless in another run. While
/// the other's is unknown, 16 zeros replace it: such a packet is a greeting, which carries its sender's
/// nonce only. Within a run packets are numbered: an older number is not taken again. Without a key nothing
/// follows, and nothing is proved. Packets are not encrypted.
class PacketSeal {
 public:
  static constexpr std::size_t kBytes = 32;

  /// @param hex  as PacketKey's; empty: no key. @throws InvalidParameter as PacketKey.
  explicit PacketSeal(std::string_view hex);

  /// Greets again: the other may have been restarted, with another nonce.
  void forget() noexcept { other_ = {}; }
  [[nodiscard]] bool hasKey() const noexcept { return key_.has_value(); }
  [[nodiscard]] Packet seal(Packet packet) const;

  enum class Proof : std::uint8_t {
    kFresh,     ///< its sender knows the key, and this end's nonce
    kGreeting,  ///< knows the key, and may have been kept from another day
    kForged,
  };
  struct Opened {
    Proof proof;
    std::span<const std::uint8_t> packet;
  };
  /// Learns the other's nonce from what is not forged.
  [[nodiscard]] Opened open(std::span<const std::uint8_t> bytes);

 private:
  std::optional<PacketKey> key_;
  PacketKey::Nonce own_{}, other_{};
};

}  // namespace haptolith
