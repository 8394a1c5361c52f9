#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "vec.h"

namespace hand_in_the_loop {

// Both packets of docs/reference/udp.md, "Any other device or program: UDP", implemented only from its tables.

/// Packet from the program that holds the tool.
struct DevicePacket {
  static constexpr std::size_t kBytes = 136;
  bool held = true;
  std::uint32_t sequence = 0, buttons = 0;
  std::uint64_t time = 0;
  Vec3 position_m = {};
  std::array<double, 4> orientation_wxyz = {1, 0, 0, 0};
  Vec3 velocity_m_s = {}, turning_rad_s = {};
  double gripper = 0;
};

/// Packet to that program after each tick.
struct Answer {
  static constexpr std::size_t kBytes = 80;
  bool live = false, let_go = false;
  std::uint32_t sequence = 0, number = 0;
  std::uint64_t time = 0;
  Vec3 force_n = {}, torque_nm = {};
  double grip_n = 0;
};

std::array<std::byte, DevicePacket::kBytes> bytesOf(const DevicePacket& packet);
std::optional<Answer> parseAnswer(std::span<const std::byte> bytes);

// Opposite direction, for the self-test's mock program.
std::array<std::byte, Answer::kBytes> bytesOf(const Answer& answer);
std::optional<DevicePacket> parseDevicePacket(std::span<const std::byte> bytes);

}  // namespace hand_in_the_loop
