#include "packets.h"

#include <bit>
#include <cstring>

namespace hand_in_the_loop {

namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in memory");

constexpr std::uint16_t kVersion = 1;

template <class T>
void put(std::span<std::byte> bytes, std::size_t offset, const T& value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}
void put(std::span<std::byte> bytes, std::size_t offset, const Vec3& v) {
  put(bytes, offset, v.x);
  put(bytes, offset + 8, v.y);
  put(bytes, offset + 16, v.z);
}

template <class T>
T get(std::span<const std::byte> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}
Vec3 getVec(std::span<const std::byte> bytes, std::size_t offset) {
  return {get<double>(bytes, offset), get<double>(bytes, offset + 8), get<double>(bytes, offset + 16)};
}

bool begins(std::span<const std::byte> bytes, const char* magic, std::size_t size) {
  return bytes.size() == size && std::memcmp(bytes.data(), magic, 4) == 0 && get<std::uint16_t>(bytes, 4) == kVersion;
}

}  // namespace

std::array<std::byte, DevicePacket::kBytes> bytesOf(const DevicePacket& packet) {
  std::array<std::byte, DevicePacket::kBytes> bytes{};
  std::memcpy(bytes.data(), "HLDV", 4);
  put(bytes, 4, kVersion);
  put(bytes, 6, static_cast<std::uint16_t>(packet.held ? 1 : 0));
  put(bytes, 8, packet.sequence);
  put(bytes, 12, packet.buttons);
  put(bytes, 16, packet.time);
  put(bytes, 24, packet.position_m);
  for (std::size_t i = 0; i < 4; ++i) {
    put(bytes, 48 + 8 * i, packet.orientation_wxyz[i]);
  }
  put(bytes, 80, packet.velocity_m_s);
  put(bytes, 104, packet.turning_rad_s);
  put(bytes, 128, packet.gripper);
  return bytes;
}

std::optional<Answer> parseAnswer(std::span<const std::byte> bytes) {
  if (!begins(bytes, "HLAN", Answer::kBytes)) {
    return std::nullopt;
  }
  const auto flags = get<std::uint16_t>(bytes, 6);
  return Answer{.live = (flags & 1) != 0,
                .let_go = (flags & 2) != 0,
                .sequence = get<std::uint32_t>(bytes, 8),
                .number = get<std::uint32_t>(bytes, 12),
                .time = get<std::uint64_t>(bytes, 16),
                .force_n = getVec(bytes, 24),
                .torque_nm = getVec(bytes, 48),
                .grip_n = get<double>(bytes, 72)};
}

std::array<std::byte, Answer::kBytes> bytesOf(const Answer& answer) {
  std::array<std::byte, Answer::kBytes> bytes{};
  std::memcpy(bytes.data(), "HLAN", 4);
  put(bytes, 4, kVersion);
  put(bytes, 6, static_cast<std::uint16_t>((answer.live ? 1 : 0) | (answer.let_go ? 2 : 0)));
  put(bytes, 8, answer.sequence);
  put(bytes, 12, answer.number);
  put(bytes, 16, answer.time);
  put(bytes, 24, answer.force_n);
  put(bytes, 48, answer.torque_nm);
  put(bytes, 72, answer.grip_n);
  return bytes;
}

std::optional<DevicePacket> parseDevicePacket(std::span<const std::byte> bytes) {
  if (!begins(bytes, "HLDV", DevicePacket::kBytes)) {
    return std::nullopt;
  }
  return DevicePacket{
      .held = (get<std::uint16_t>(bytes, 6) & 1) != 0,
      .sequence = get<std::uint32_t>(bytes, 8),
      .buttons = get<std::uint32_t>(bytes, 12),
      .time = get<std::uint64_t>(bytes, 16),
      .position_m = getVec(bytes, 24),
      .orientation_wxyz = {get<double>(bytes, 48), get<double>(bytes, 56), get<double>(bytes, 64),
                           get<double>(bytes, 72)},
      .velocity_m_s = getVec(bytes, 80),
      .turning_rad_s = getVec(bytes, 104),
      .gripper = get<double>(bytes, 128),
  };
}

}  // namespace hand_in_the_loop
