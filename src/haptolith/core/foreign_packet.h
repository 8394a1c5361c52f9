#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace haptolith {

/// Size and first bytes of a packet, for a later message about it. May be copied in the tick.
struct PacketHead {
  std::size_t size = 0;
  std::array<std::byte, 24> bytes{};  ///< zeros beyond `size`

  PacketHead() = default;
  explicit PacketHead(std::span<const std::byte> packet) noexcept;
};

/// Header of a packet format: four letters, then a version of 16 bits, little-endian.
struct PacketForm {
  std::string_view magic;
  std::uint16_t version = 1;
  std::size_t size = 0;  ///< 0: any
};

/// Describes why a packet does not have this form, for a message to the author of its sender: "57 bytes of text,
/// '{"x": 0.1, ...'". Empty when header and size fit. Not for the tick.
[[nodiscard]] std::string describeMismatch(const PacketHead& head, const PacketForm& form);

}  // namespace haptolith
