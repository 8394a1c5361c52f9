#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace haptolith {

/// What both ends of a network device, or of a teleoperation, know, and nobody else: with it each packet is signed. A
/// tag is
///
///     BLAKE2b(key = K, nonce || packet), 16 bytes                    (RFC 7693; Python: hashlib.blake2b(..., key=K))
///
/// The nonce is another one for everybody who takes the tool, each time: what somebody has listened to is of no use
/// later. Packets are signed, not encrypted. Functions may be called in the tick, and in a signal's handler.
class PacketKey {
 public:
  static constexpr std::size_t kTagBytes = 16;
  using Tag = std::array<std::byte, kTagBytes>;
  using Nonce = std::array<std::byte, 16>;

  /// @param hex  64 hexadecimal digits. Not for the tick. @throws InvalidParameter for anything else; it does not say
  /// what.
  explicit PacketKey(std::string_view hex);

  [[nodiscard]] Tag tagOf(std::span<const std::byte> packet, const Nonce& nonce) const noexcept;

  /// Whether these bytes are the packet's tag, in a time that does not tell how many are.
  [[nodiscard]] bool signs(std::span<const std::byte> tag, std::span<const std::byte> packet,
                           const Nonce& nonce) const noexcept;

  /// A nonce for one sender, as long as `epoch` stays the same. Nobody can guess it, and none has to be kept.
  [[nodiscard]] Nonce nonceFor(std::uint64_t sender, std::uint64_t epoch) const noexcept;

 private:
  std::array<unsigned char, 32> key_{}, secret_{};
};

}  // namespace haptolith
