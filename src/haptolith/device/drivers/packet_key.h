#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace haptolith {

/// Shared secret of both ends of a network device, or of a teleoperation: it signs each packet. A
/// tag is
///
///     BLAKE2b(key = K, nonce || packet), 16 bytes                    (RFC 7693; Python: hashlib.blake2b(..., key=K))
///
/// The nonce changes each time a sender takes the tool: intercepted packets are useless
/// later. Packets are signed, not encrypted. Functions may be called in the tick, and in a signal's handler.
class PacketKey {
 public:
  static constexpr std::size_t kTagBytes = 16;
  using Tag = std::array<std::byte, kTagBytes>;
  using Nonce = std::array<std::byte, 16>;

  /// @param hex  64 hexadecimal digits. Not for the tick. @throws InvalidParameter for anything else, without repeating
  /// the text.
  explicit PacketKey(std::string_view hex);

  [[nodiscard]] Tag tagOf(std::span<const std::byte> packet, const Nonce& nonce) const noexcept;

  /// Whether these bytes are the packet's tag, compared in constant time.
  [[nodiscard]] bool signs(std::span<const std::byte> tag, std::span<const std::byte> packet,
                           const Nonce& nonce) const noexcept;

  /// A nonce for one sender, while `epoch` is constant. It is unguessable and needs no storage.
  [[nodiscard]] Nonce nonceFor(std::uint64_t sender, std::uint64_t epoch) const noexcept;

 private:
  std::array<unsigned char, 32> key_{}, secret_{};
};

}  // namespace haptolith
