#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/teleop/link/link.h"

namespace haptolith {

/// Map packet of the robot, at about 20 Hz over a good link: heights of the soil in a part of its site,
/// from its camera. A robot without a camera sends none. One UDP packet of 56 + 2 w h bytes, little-endian:
///
///     offset  type    what
///          0  u8[4]   "HLTM"
///          4  u16     version, 1
///          6  u16     0
///          8  u32     its own connection, as in its StatePackets
///         12  u16     columns of the whole map, along x: 1 to 1024
///         14  u16     rows, along y: 1 to 1024; columns times rows: 65536 at most
///         16  f32     x of the corner of the map's first cell, m      site frame; within 100 m
///         20  f32     y of it
///         24  f32     width of a cell, m                              1e-4 to 1
///         28  u16     first column that the packet is about
///         30  u16     first row
///         32  u16     w, columns of the packet: 1 to 16
///         34  u16     h, rows: 1 to 16
///         36  u32     0
///         40  u64     number of this packet, one more with each
///         48  u64     index of the command that the robot had come to when it looked
///     then w h numbers, row by row:
///          0  i16     height over the site's zero, in steps of 0.1 mm; -32768: not seen
struct SitePacket {
  static constexpr std::size_t kHeaderBytes = 56, kSide = 16, kMostAlong = 1024, kMostCells = 65536;
  static constexpr std::string_view kMagic = "HLTM";
  static constexpr std::uint16_t kVersion = 1;
  static constexpr double kStep_m = 1e-4;
  static constexpr std::int16_t kNotSeen = -32768;

  std::uint32_t robot_connection = 0;
  HeightGrid grid;  ///< grid of the complete map
  std::size_t column = 0, row = 0, columns = 0, rows = 0;
  std::uint64_t number = 0, index = 0;
  std::vector<std::int16_t> steps = {};
};

/// Reads a packet from any sender; empty when it is malformed: wrong size, magic, version or connection 0, a number
/// that is NaN, infinite or out of range, a part that is not of the map. Not for the tick.
[[nodiscard]] std::optional<SitePacket> parseSite(std::span<const std::uint8_t> bytes);
[[nodiscard]] Packet bytesOf(const SitePacket& packet);

}  // namespace haptolith
