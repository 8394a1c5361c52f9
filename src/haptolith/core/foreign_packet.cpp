#include "haptolith/core/foreign_packet.h"

#include <fmt/format.h>

#include <algorithm>

namespace haptolith {

namespace {

constexpr std::size_t kMagicBytes = 4, kVersionEnd = 6;

char letter(std::byte byte) {
  return static_cast<char>(byte);
}

bool isText(std::byte byte) {
  const char c = letter(byte);
  return (c >= ' ' && c <= '~') || c == '\n' || c == '\r' || c == '\t';
}

/// The bytes as text, with a dot for each that is not printable.
std::string readable(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    text += letter(byte) >= ' ' && letter(byte) <= '~' ? letter(byte) : '.';
  }
  return text;
}

}  // namespace

PacketHead::PacketHead(std::span<const std::byte> packet) noexcept : size(packet.size()) {
  std::ranges::copy(packet.first(std::min(packet.size(), bytes.size())), bytes.begin());
}

std::string describeMismatch(const PacketHead& head, const PacketForm& form) {
  const std::span<const std::byte> bytes = std::span(head.bytes).first(std::min(head.size, head.bytes.size()));
  if (bytes.empty()) {
    return "an empty packet";
  }
  const bool is_ours = bytes.size() >= kVersionEnd && readable(bytes.first(kMagicBytes)) == form.magic;
  if (!is_ours && std::ranges::all_of(bytes, isText)) {
    return fmt::format("{} bytes of text, '{}{}'", head.size, readable(bytes), head.size > bytes.size() ? "..." : "");
  }
  std::string turned = bytes.size() >= kMagicBytes ? readable(bytes.first(kMagicBytes)) : "";
  std::ranges::reverse(turned);
  const unsigned version =
      is_ours ? static_cast<unsigned>(bytes[kMagicBytes]) | static_cast<unsigned>(bytes[kMagicBytes + 1]) << 8U : 0;
  if (turned == form.magic || (is_ours && version == static_cast<unsigned>(form.version) << 8U)) {
    return "numbers in big-endian byte order: must be little-endian";
  }
  if (!is_ours) {
    return fmt::format("{} bytes that begin with '{}' instead of {}", head.size,
                       readable(bytes.first(std::min(bytes.size(), kMagicBytes))), form.magic);
  }
  if (version != form.version) {
    return fmt::format("format version {}: must be {}", version, form.version);
  }
  if (form.size != 0 && head.size != form.size) {
    return fmt::format("{} bytes: must be {}", head.size, form.size);
  }
  return "";
}

}  // namespace haptolith
