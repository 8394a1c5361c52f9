#include "haptolith/device/drivers/packet_key.h"

#include <sodium.h>

#include <algorithm>
#include <cstring>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

constexpr std::size_t kLongest = 216;  // bytes, with the nonce

PacketKey::Tag blake2b(std::span<const unsigned char> message, const std::array<unsigned char, 32>& key) noexcept {
  std::array<unsigned char, PacketKey::kTagBytes> hash{};
  crypto_generichash(hash.data(), hash.size(), message.data(), message.size(), key.data(), key.size());
  PacketKey::Tag tag{};
  std::memcpy(tag.data(), hash.data(), tag.size());
  return tag;
}

}  // namespace

PacketKey::PacketKey(std::string_view hex) {
  std::size_t bytes = 0;
  if (sodium_init() < 0 || hex.size() != 2 * key_.size() ||
      sodium_hex2bin(key_.data(), key_.size(), hex.data(), hex.size(), nullptr, &bytes, nullptr) != 0 ||
      bytes != key_.size()) {
    throw InvalidParameter("the network device's key", "(not shown)",
                           "64 hexadecimal digits, as `openssl rand -hex 32` prints them");
  }
  randombytes_buf(secret_.data(), secret_.size());
}

PacketKey::Tag PacketKey::tagOf(std::span<const std::byte> packet, const Nonce& nonce) const noexcept {
  std::array<unsigned char, kLongest> message;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled as far as used
  const std::size_t size = std::min(packet.size(), kLongest - nonce.size());
  std::memcpy(message.data(), nonce.data(), nonce.size());
  std::memcpy(message.data() + nonce.size(), packet.data(), size);
  return blake2b(std::span(message).first(nonce.size() + size), key_);
}

bool PacketKey::signs(std::span<const std::byte> tag, std::span<const std::byte> packet,
                      const Nonce& nonce) const noexcept {
  const Tag right = tagOf(packet, nonce);
  return tag.size() == right.size() && sodium_memcmp(tag.data(), right.data(), right.size()) == 0;
}

PacketKey::Nonce PacketKey::nonceFor(std::uint64_t sender, std::uint64_t epoch) const noexcept {
  std::array<unsigned char, 16> message{};
  std::memcpy(message.data(), &sender, 8);
  std::memcpy(message.data() + 8, &epoch, 8);
  return blake2b(message, secret_);
}

}  // namespace haptolith
