#include "haptolith/teleop/link/packet_seal.h"

#include <algorithm>
#include <cstddef>
#include <random>

namespace haptolith {

namespace {

constexpr std::size_t kNonceBytes = sizeof(PacketKey::Nonce);
static_assert(PacketSeal::kBytes == kNonceBytes + PacketKey::kTagBytes);

void append(Packet& packet, std::span<const std::byte> bytes) {
  for (const std::byte byte : bytes) {
    packet.push_back(static_cast<std::uint8_t>(byte));
  }
}

}  // namespace

PacketSeal::PacketSeal(std::string_view hex) {
  if (hex.empty()) {
    return;
  }
  key_.emplace(hex);
  std::random_device random;
  own_ = key_->nonceFor(std::uint64_t{random()} << 32 | random(), 0);  // from a secret of this run
}

Packet PacketSeal::seal(Packet packet) const {
  if (key_) {
    append(packet, own_);
    append(packet, key_->tagOf(std::as_bytes(std::span(packet)), other_));
  }
  return packet;
}

PacketSeal::Opened PacketSeal::open(std::span<const std::uint8_t> bytes) {
  if (!key_) {
    return {Proof::kFresh, bytes};
  }
  if (bytes.size() < kBytes) {
    return {Proof::kForged, {}};
  }
  const auto all = std::as_bytes(bytes);
  const auto tag = all.last(PacketKey::kTagBytes);
  const auto message = all.first(bytes.size() - PacketKey::kTagBytes);
  const bool fresh = key_->signs(tag, message, own_);
  if (!fresh && !key_->signs(tag, message, PacketKey::Nonce{})) {
    return {Proof::kForged, {}};
  }
  std::ranges::copy(message.last(kNonceBytes), other_.begin());
  return {fresh ? Proof::kFresh : Proof::kGreeting, bytes.first(bytes.size() - kBytes)};
}

}  // namespace haptolith
