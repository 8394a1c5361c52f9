#include "haptolith/device/drivers/packet_key.h"

#include <sodium.h>

#include <cstring>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

PacketKey::Tag blake2b(std::span<const std::byte> first, std::span<const std::byte> then,
                       const std::array<unsigned char, 32>& key) noexcept {
  std::array<unsigned char, PacketKey::kTagBytes> hash{};
  crypto_generichash_state state;  // NOLINT(cppcoreguidelines-pro-type-member-init): by the next call
  crypto_generichash_init(&state, key.data(), key.size(), hash.size());
  for (const std::span<const std::byte> part : {first, then}) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the library's bytes
    crypto_generichash_update(&state, reinterpret_cast<const unsigned char*>(part.data()), part.size());
  }
  crypto_generichash_final(&state, hash.data(), hash.size());
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
    throw InvalidParameter("the key of packets", "(not shown)",
                           "64 hexadecimal digits, as `openssl rand -hex 32` prints them");
  }
  randombytes_buf(secret_.data(), secret_.size());
}

PacketKey::Tag PacketKey::tagOf(std::span<const std::byte> packet, const Nonce& nonce) const noexcept {
  return blake2b(nonce, packet, key_);
}

bool PacketKey::signs(std::span<const std::byte> tag, std::span<const std::byte> packet,
                      const Nonce& nonce) const noexcept {
  const Tag right = tagOf(packet, nonce);
  return tag.size() == right.size() && sodium_memcmp(tag.data(), right.data(), right.size()) == 0;
}

PacketKey::Nonce PacketKey::nonceFor(std::uint64_t sender, std::uint64_t epoch) const noexcept {
  return blake2b(std::as_bytes(std::span(&sender, 1)), std::as_bytes(std::span(&epoch, 1)), secret_);
}

}  // namespace haptolith
