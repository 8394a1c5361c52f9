#include "haptolith/device/drivers/device_packet.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "haptolith/core/packet_bytes.h"
#include "haptolith/device/drivers/packet_key.h"

namespace haptolith {

namespace {

constexpr std::string_view kDeviceMagic = "HLDV";
constexpr std::string_view kAnswerMagic = "HLAN";
constexpr std::uint16_t kHeld = 1;
constexpr std::uint16_t kLive = 1;
constexpr std::uint16_t kLetGo = 2;

// Ten times what an arm reaches and does: who sends more is broken, or mistakes a unit.
constexpr double kLargestPosition_m = 10;
constexpr double kLargestSpeed_m_s = 100;
constexpr double kLargestTurning_rad_s = 1000;

bool isWithin(double largest, const Vec3& v) noexcept {
  return v.cwiseAbs().maxCoeff() <= largest;
}

/// Fault in a packet's values; empty for a valid one.
std::optional<PacketFault> faultIn(const DevicePacket& packet) noexcept {
  const bool finite = packet.pose.position_m.allFinite() && packet.pose.orientation.coeffs().allFinite() &&
                      packet.twist.linear_m_s.allFinite() && packet.twist.angular_rad_s.allFinite() &&
                      std::isfinite(packet.gripper_open);
  if (!finite) {
    return PacketFault::kNotFinite;
  }
  if (!isUnit(packet.pose.orientation)) {
    return PacketFault::kNotUnit;
  }
  const bool in_range = isWithin(kLargestPosition_m, packet.pose.position_m) &&
                        isWithin(kLargestSpeed_m_s, packet.twist.linear_m_s) &&
                        isWithin(kLargestTurning_rad_s, packet.twist.angular_rad_s) && packet.gripper_open >= 0 &&
                        packet.gripper_open <= 1;
  return in_range ? std::nullopt : std::optional(PacketFault::kRange);
}

std::optional<PacketFault> read(std::span<const std::byte> bytes, DevicePacket& packet) noexcept {
  if (bytes.size() != DevicePacket::kBytes) {
    return PacketFault::kSize;
  }
  PacketReader reader(bytes);
  if (!reader.nextIs(kDeviceMagic)) {
    return PacketFault::kMagic;
  }
  if (reader.next<std::uint16_t>() != DevicePacket::kVersion) {
    return PacketFault::kVersion;
  }
  packet.held = (reader.next<std::uint16_t>() & kHeld) != 0;
  reader.read(packet.sequence);
  reader.read(packet.buttons);
  reader.read(packet.sender_time);
  reader.readVector(packet.pose.position_m);
  reader.readQuaternion(packet.pose.orientation);
  reader.readVector(packet.twist.linear_m_s);
  reader.readVector(packet.twist.angular_rad_s);
  reader.read(packet.gripper_open);
  return faultIn(packet);
}

}  // namespace

std::optional<DevicePacket> parse(std::span<const std::byte> bytes, PacketFault* fault) noexcept {
  DevicePacket packet;
  if (const std::optional<PacketFault> found = read(bytes, packet)) {
    if (fault != nullptr) {
      *fault = *found;
    }
    return std::nullopt;
  }
  packet.pose.orientation.normalize();
  return packet;
}

std::string describe(PacketFault fault, const PacketHead& head, bool signed_packets) {
  constexpr std::size_t kSigned = DevicePacket::kBytes + PacketKey::kTagBytes;
  const PacketForm form{kDeviceMagic, DevicePacket::kVersion, signed_packets ? kSigned : DevicePacket::kBytes};
  std::string mismatch = describeMismatch(head, form);
  switch (fault) {
    case PacketFault::kSize:
      if (head.size == kSigned && describeMismatch(head, {kDeviceMagic, DevicePacket::kVersion, kSigned}).empty()) {
        return "signed, but this program was started without --device-key-file";
      }
      if (head.size == DevicePacket::kBytes &&
          describeMismatch(head, {kDeviceMagic, DevicePacket::kVersion, DevicePacket::kBytes}).empty()) {
        return "not signed, but this program was started with a key";
      }
      return mismatch;
    case PacketFault::kMagic:
    case PacketFault::kVersion: return mismatch;
    case PacketFault::kNotFinite: return "a number is NaN or infinite";
    case PacketFault::kNotUnit: return "the orientation, w x y z, is not of unit length within 1 %";
    case PacketFault::kRange:
      return fmt::format(
          "a number is out of range: position within {:g} m, velocity within {:g} m/s and {:g} rad/s, gripper 0 "
          "to 1",
          kLargestPosition_m, kLargestSpeed_m_s, kLargestTurning_rad_s);
  }
  return mismatch;
}

std::optional<AnswerPacket> parseAnswer(std::span<const std::byte> bytes) noexcept {
  if (bytes.size() != AnswerPacket::kBytes) {
    return std::nullopt;
  }
  PacketReader reader(bytes);
  if (!reader.nextIs(kAnswerMagic) || reader.next<std::uint16_t>() != AnswerPacket::kVersion) {
    return std::nullopt;
  }
  AnswerPacket packet;
  const auto flags = reader.next<std::uint16_t>();
  packet.live = (flags & kLive) != 0;
  packet.let_go = (flags & kLetGo) != 0;
  reader.read(packet.sequence);
  reader.read(packet.number);
  reader.read(packet.sender_time);
  reader.readVector(packet.output.wrench.force_n);
  reader.readVector(packet.output.wrench.torque_nm);
  reader.read(packet.output.gripper_force_n);
  const bool finite = packet.output.wrench.force_n.allFinite() && packet.output.wrench.torque_nm.allFinite() &&
                      std::isfinite(packet.output.gripper_force_n);
  return finite ? std::optional(packet) : std::nullopt;
}

std::array<std::byte, DevicePacket::kBytes> bytesOf(const DevicePacket& packet) noexcept {
  std::array<std::byte, DevicePacket::kBytes> bytes{};
  PacketWriter writer(bytes);
  writer.writeMagic(kDeviceMagic);
  writer.write(DevicePacket::kVersion);
  writer.write(packet.held ? kHeld : std::uint16_t{0});
  writer.write(packet.sequence);
  writer.write(packet.buttons);
  writer.write(packet.sender_time);
  writer.writeVector(packet.pose.position_m);
  writer.writeQuaternion(packet.pose.orientation);
  writer.writeVector(packet.twist.linear_m_s);
  writer.writeVector(packet.twist.angular_rad_s);
  writer.write(packet.gripper_open);
  return bytes;
}

std::array<std::byte, AnswerPacket::kBytes> bytesOf(const AnswerPacket& packet) noexcept {
  std::array<std::byte, AnswerPacket::kBytes> bytes{};
  PacketWriter writer(bytes);
  writer.writeMagic(kAnswerMagic);
  writer.write(AnswerPacket::kVersion);
  writer.write(static_cast<std::uint16_t>((packet.live ? kLive : 0) | (packet.let_go ? kLetGo : 0)));
  writer.write(packet.sequence);
  writer.write(packet.number);
  writer.write(packet.sender_time);
  writer.writeVector(packet.output.wrench.force_n);
  writer.writeVector(packet.output.wrench.torque_nm);
  writer.write(packet.output.gripper_force_n);
  return bytes;
}

}  // namespace haptolith
