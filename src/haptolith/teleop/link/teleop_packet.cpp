#include "haptolith/teleop/link/teleop_packet.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>

#include "haptolith/core/foreign_packet.h"
#include "haptolith/core/packet_bytes.h"
#include "haptolith/teleop/link/site_packet.h"

namespace haptolith {

namespace {

constexpr std::string_view kCommandMagic = "HLTC", kStateMagic = "HLTS";
constexpr std::uint16_t kHeld = 1, kTare = 2;
constexpr std::uint16_t kAtForceCap = 1, kAtSpeedCap = 2, kAtEdge = 4;

// As DevicePacket's: ten times what an arm reaches and does.
constexpr double kLargestPosition_m = 10;
constexpr double kLargestSpeed_m_s = 100;
constexpr double kLargestTurning_rad_s = 1000;
constexpr double kLargestForce_n = 1e5;

/// Whether each is a number of at most that size.
bool isWithin(double largest, const Vec3& v) noexcept {
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= largest;
}

bool makesSense(Pose& pose) noexcept {
  const bool good = isWithin(kLargestPosition_m, pose.position_m) && isUnit(pose.orientation);
  pose.orientation.normalize();
  return good;
}

bool makesSense(Keyframe& key) noexcept {
  return makesSense(key.hand.pose) && isWithin(kLargestSpeed_m_s, key.hand.twist.linear_m_s) &&
         isWithin(kLargestTurning_rad_s, key.hand.twist.angular_rad_s) && key.hand.opening >= 0 &&
         key.hand.opening <= 1;
}

bool makesSense(RobotReport& report) noexcept {
  return makesSense(report.pose) && isWithin(kLargestForce_n, report.met.force_n) &&
         isWithin(kLargestForce_n, report.met.torque_nm) && report.ticks <= report.index;
}

Keyframe nextKey(PacketReader& reader) noexcept {
  Keyframe key;
  reader.read(key.index);
  reader.readVector<float>(key.hand.pose.position_m);
  reader.readQuaternion<float>(key.hand.pose.orientation);
  reader.readVector<float>(key.hand.twist.linear_m_s);
  reader.readVector<float>(key.hand.twist.angular_rad_s);
  key.hand.opening = static_cast<double>(reader.next<float>());
  return key;
}

RobotReport nextReport(PacketReader& reader) noexcept {
  RobotReport report;
  reader.read(report.index);
  reader.read(report.ticks);
  (void)reader.next<std::uint32_t>();
  reader.readVector<float>(report.pose.position_m);
  reader.readQuaternion<float>(report.pose.orientation);
  reader.readVector<float>(report.met.force_n);
  reader.readVector<float>(report.met.torque_nm);
  (void)reader.next<float>();
  return report;
}

/// Reads `count` of them; false when one makes no sense.
template <class Key>
bool readGrowing(PacketReader& reader, std::size_t count, Key (&next)(PacketReader&) noexcept,
                 std::vector<Key>& keyframes) {
  for (std::size_t i = 0; i < count; ++i) {
    Key key = next(reader);
    if (!makesSense(key) || (!keyframes.empty() && key.index <= keyframes.back().index)) {
      return false;
    }
    keyframes.push_back(key);
  }
  return true;
}

bool begins(PacketReader& reader, std::span<const std::uint8_t> bytes, std::size_t header_bytes, std::string_view magic,
            std::uint16_t version) noexcept {
  return bytes.size() >= header_bytes && reader.nextIs(magic) && reader.next<std::uint16_t>() == version;
}

void requireCount(const char* key, std::size_t count, std::size_t most) {
  requireInRange(key, static_cast<double>(count), {1, static_cast<double>(most)});
}

std::string describeMalformed(std::span<const std::uint8_t> bytes, const PacketForm& form) {
  const std::string mismatch = describeMismatch(PacketHead(std::as_bytes(bytes)), form);
  return mismatch.empty() ? "truncated, or a number is NaN, infinite or out of range" : mismatch;
}

}  // namespace

std::string describeMalformedCommand(std::span<const std::uint8_t> bytes) {
  return describeMalformed(bytes, {kCommandMagic, CommandPacket::kVersion});
}

std::string describeMalformedReport(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kMagic = SitePacket::kMagic;
  const bool of_site = bytes.size() >= kMagic.size() && std::ranges::equal(bytes.first(kMagic.size()), kMagic);
  return describeMalformed(
      bytes, of_site ? PacketForm{kMagic, SitePacket::kVersion} : PacketForm{kStateMagic, StatePacket::kVersion});
}

std::optional<CommandPacket> parseCommand(std::span<const std::uint8_t> bytes) {
  PacketReader reader(std::as_bytes(bytes));
  if (!begins(reader, bytes, CommandPacket::kHeaderBytes, kCommandMagic, CommandPacket::kVersion)) {
    return std::nullopt;
  }
  CommandPacket packet;
  const auto flags = reader.next<std::uint16_t>();
  packet.held = (flags & kHeld) != 0;
  packet.tare = (flags & kTare) != 0;
  reader.read(packet.connection);
  const std::size_t count = reader.next<std::uint32_t>();
  reader.read(packet.number);
  reader.read(packet.sender_time);
  const bool fits = packet.connection != 0 && count >= 1 && count <= CommandPacket::kMostKeyframes &&
                    bytes.size() == CommandPacket::kHeaderBytes + count * CommandPacket::kKeyframeBytes;
  return fits && readGrowing(reader, count, nextKey, packet.keyframes) ? std::optional(packet) : std::nullopt;
}

std::optional<StatePacket> parseState(std::span<const std::uint8_t> bytes) {
  PacketReader reader(std::as_bytes(bytes));
  if (!begins(reader, bytes, StatePacket::kHeaderBytes, kStateMagic, StatePacket::kVersion)) {
    return std::nullopt;
  }
  StatePacket packet;
  const auto flags = reader.next<std::uint16_t>();
  packet.at_force_cap = (flags & kAtForceCap) != 0;
  packet.at_speed_cap = (flags & kAtSpeedCap) != 0;
  packet.at_edge = (flags & kAtEdge) != 0;
  reader.read(packet.operator_connection);
  reader.read(packet.robot_connection);
  reader.read(packet.number);
  reader.read(packet.sender_time);
  reader.read(packet.newest);
  const auto state = reader.next<std::uint8_t>();
  const auto reason = reader.next<std::uint8_t>();
  const std::size_t count = reader.next<std::uint16_t>();
  (void)reader.next<std::uint32_t>();
  const bool fits = packet.robot_connection != 0 && state <= static_cast<std::uint8_t>(RobotState::kFailed) &&
                    reason <= static_cast<std::uint8_t>(StopReason::kFault) && count >= 1 &&
                    count <= StatePacket::kMostReports &&
                    bytes.size() == StatePacket::kHeaderBytes + count * StatePacket::kReportBytes;
  if (!fits) {
    return std::nullopt;
  }
  packet.state = static_cast<RobotState>(state);
  packet.reason = static_cast<StopReason>(reason);
  return readGrowing(reader, count, nextReport, packet.reports) ? std::optional(packet) : std::nullopt;
}

Packet bytesOf(const CommandPacket& packet) {
  requireCount("keyframes", packet.keyframes.size(), CommandPacket::kMostKeyframes);
  Packet bytes(CommandPacket::kHeaderBytes + packet.keyframes.size() * CommandPacket::kKeyframeBytes);
  PacketWriter writer(std::as_writable_bytes(std::span(bytes)));
  writer.writeMagic(kCommandMagic);
  writer.write(CommandPacket::kVersion);
  writer.write(static_cast<std::uint16_t>((packet.held ? kHeld : 0) | (packet.tare ? kTare : 0)));
  writer.write(packet.connection);
  writer.write(static_cast<std::uint32_t>(packet.keyframes.size()));
  writer.write(packet.number);
  writer.write(packet.sender_time);
  for (const Keyframe& key : packet.keyframes) {
    writer.write(key.index);
    writer.writeVector<float>(key.hand.pose.position_m);
    writer.writeQuaternion<float>(key.hand.pose.orientation);
    writer.writeVector<float>(key.hand.twist.linear_m_s);
    writer.writeVector<float>(key.hand.twist.angular_rad_s);
    writer.write(static_cast<float>(key.hand.opening));
  }
  return bytes;
}

Packet bytesOf(const StatePacket& packet) {
  requireCount("reports", packet.reports.size(), StatePacket::kMostReports);
  Packet bytes(StatePacket::kHeaderBytes + packet.reports.size() * StatePacket::kReportBytes);
  PacketWriter writer(std::as_writable_bytes(std::span(bytes)));
  writer.writeMagic(kStateMagic);
  writer.write(StatePacket::kVersion);
  writer.write(static_cast<std::uint16_t>((packet.at_force_cap ? kAtForceCap : 0) |
                                          (packet.at_speed_cap ? kAtSpeedCap : 0) | (packet.at_edge ? kAtEdge : 0)));
  writer.write(packet.operator_connection);
  writer.write(packet.robot_connection);
  writer.write(packet.number);
  writer.write(packet.sender_time);
  writer.write(packet.newest);
  writer.write(static_cast<std::uint8_t>(packet.state));
  writer.write(static_cast<std::uint8_t>(packet.reason));
  writer.write(static_cast<std::uint16_t>(packet.reports.size()));
  writer.write(std::uint32_t{0});
  for (const RobotReport& report : packet.reports) {
    writer.write(report.index);
    writer.write(report.ticks);
    writer.write(std::uint32_t{0});
    writer.writeVector<float>(report.pose.position_m);
    writer.writeQuaternion<float>(report.pose.orientation);
    writer.writeVector<float>(report.met.force_n);
    writer.writeVector<float>(report.met.torque_nm);
    writer.write(0.0F);
  }
  return bytes;
}

std::vector<std::size_t> commandLags(double period_s, std::size_t keyframes) {
  constexpr double kWidest_s = 0.3;
  const auto widest = std::max<std::size_t>(1, static_cast<std::size_t>(std::llround(kWidest_s / period_s)));
  std::vector<std::size_t> lags{0};
  while (lags.size() < keyframes) {
    const std::size_t last = lags.back();
    lags.push_back(last + std::clamp<std::size_t>(last, 1, widest));
  }
  std::ranges::reverse(lags);
  return lags;
}

std::vector<std::size_t> reportLags(std::size_t keyframes) {
  std::vector<std::size_t> lags(keyframes);
  std::iota(lags.rbegin(), lags.rend(), 0);
  return lags;
}

Sending sendingOver(const LinkParameters& up, const LinkParameters& down) {
  constexpr double kShare = 0.8;
  constexpr double kBitsPerByte = 8;
  constexpr double kRarely_s = 0.1;
  // As many keyframes as fit, up to those wanted.
  const auto fit = [&](const LinkParameters& way, double period_s, std::size_t header, std::size_t each,
                       std::size_t wanted) {
    if (way.rate_bit_s == 0) {
      return wanted;
    }
    const double bytes = kShare * way.rate_bit_s * period_s / kBitsPerByte;
    const double left = bytes - static_cast<double>(header) - way.overhead_bytes;
    return std::clamp<std::size_t>(static_cast<std::size_t>(std::max(0.0, left / static_cast<double>(each))), 1,
                                   wanted);
  };
  Sending sending;
  constexpr std::size_t kFewest = 8;
  const auto keyframes = [&](std::size_t wanted) {
    return fit(up, sending.period_s, CommandPacket::kHeaderBytes, CommandPacket::kKeyframeBytes, wanted);
  };
  const std::size_t wanted = sending.command_keyframes;
  if (keyframes(wanted) < kFewest) {
    sending.period_s = kRarely_s;
  }
  sending.command_keyframes = keyframes(wanted);
  sending.report_keys =
      fit(down, sending.period_s, StatePacket::kHeaderBytes, StatePacket::kReportBytes, sending.report_keys);
  if (down.rate_bit_s > 0) {
    constexpr double kShareOfSite = 0.1;
    constexpr std::size_t kLargest = SitePacket::kHeaderBytes + 2 * SitePacket::kSide * SitePacket::kSide;
    const double bits = kBitsPerByte * (static_cast<double>(kLargest) + down.overhead_bytes);
    sending.site_period_s = std::max(sending.site_period_s, bits / (kShareOfSite * down.rate_bit_s));
  }
  return sending;
}

}  // namespace haptolith
