#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "haptolith/core/foreign_packet.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Packet that a program sends at 1 kHz to hold the tool as the network device. One UDP packet of 136
/// bytes, little-endian, numbers as IEEE 754 doubles, in the sender's own right-handed frame:
///
///     offset  type    what
///          0  u8[4]   "HLDV"
///          4  u16     version, 1
///          6  u16     flags: bit 0 the dead-man switch is held; the other bits are ignored
///          8  u32     sequence number, one more with each packet; after 4294967295 comes 0
///         12  u32     buttons: bit n, button n is down
///         16  u64     the sender's time, returned in the answer; its unit is the sender's own
///         24  f64[3]  position, m                 each within 10 m
///         48  f64[4]  orientation, w x y z        of unit length within 1 %
///         80  f64[3]  linear velocity, m/s        each within 100 m/s
///        104  f64[3]  angular velocity, rad/s     each within 1000 rad/s
///        128  f64     gripper, 0 closed to 1 wide open
///
/// There is no checksum: UDP has its own. With a key (PacketKey) 16 bytes of a tag follow, 152 in all.
struct DevicePacket {
  static constexpr std::size_t kBytes = 136;
  static constexpr std::uint16_t kVersion = 1;

  bool held = false;  ///< the dead-man switch
  std::uint32_t sequence = 0;
  std::uint32_t buttons = 0;
  std::uint64_t sender_time = 0;
  Pose pose;    ///< handle, device frame
  Twist twist;  ///< handle, device frame
  double gripper_open = 0;
};

/// Answer to it: the force for its hand. At most one answer to each packet, after a tick; and one more, with zero
/// force, when it falls silent and when it is released. One UDP packet of 80 bytes:
///
///     offset  type    what
///          0  u8[4]   "HLAN"
///          4  u16     version, 1
///          6  u16     flags: bit 0 the sender is trusted (its packets are fresh and its dead-man switch is held);
///                            bit 1 forces have been released and stay zero
///          8  u32     sequence number of the newest packet that was taken
///         12  u32     number of this answer, one more with each
///         16  u64     the sender's time in that packet: now less this is the round trip
///         24  f64[3]  force on the hand, N
///         48  f64[3]  torque about the handle's origin, N m
///         72  f64     gripper force, N; > 0 opens the fingers
///
/// With a key 16 bytes follow of the nonce that the sender has to sign with, and 16 of a tag, 112 in all; the tag is
/// made of the 96 bytes before it, with a nonce of zeros.
struct AnswerPacket {
  static constexpr std::size_t kBytes = 80;
  static constexpr std::uint16_t kVersion = 1;

  bool live = false;
  bool let_go = false;
  std::uint32_t sequence = 0;
  std::uint32_t number = 0;
  std::uint64_t sender_time = 0;
  DeviceOutput output;  ///< device frame
};

/// Why a packet is not taken.
enum class PacketFault : std::uint8_t {
  kSize,
  kMagic,
  kVersion,
  kNotFinite,
  kNotUnit,  ///< the quaternion
  kRange,
};
inline constexpr std::size_t kPacketFaults = 6;

/// Reads a packet from any sender; empty when it is malformed, for the first reason in PacketFault's order. The
/// quaternion comes out of exactly unit length. May be called in the tick.
/// @param fault  set when the result is empty.
[[nodiscard]] std::optional<DevicePacket> parse(std::span<const std::byte> bytes,
                                                PacketFault* fault = nullptr) noexcept;

/// Describes a fault for a message to the author of the sender. Not for the tick.
/// @param signed_packets  whether the device has a key, so that a tag must follow each packet.
[[nodiscard]] std::string describe(PacketFault fault, const PacketHead& head, bool signed_packets);

/// As parse(), for the program that holds the tool: an answer of wrong size, magic or version, or with a force that is
/// NaN or infinite, is dropped.
[[nodiscard]] std::optional<AnswerPacket> parseAnswer(std::span<const std::byte> bytes) noexcept;

/// May be called in the tick.
[[nodiscard]] std::array<std::byte, DevicePacket::kBytes> bytesOf(const DevicePacket& packet) noexcept;
[[nodiscard]] std::array<std::byte, AnswerPacket::kBytes> bytesOf(const AnswerPacket& packet) noexcept;

}  // namespace haptolith
