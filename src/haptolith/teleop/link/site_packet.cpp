#include "haptolith/teleop/link/site_packet.h"

#include <cmath>

#include "haptolith/core/packet_bytes.h"

namespace haptolith {

namespace {

constexpr double kFurthest_m = 100;
constexpr double kSmallestCell_m = 1e-4, kLargestCell_m = 1;

bool isPart(std::size_t first, std::size_t count, std::size_t of) noexcept {
  return count >= 1 && count <= SitePacket::kSide && of >= 1 && of <= SitePacket::kMostAlong && first + count <= of;
}

bool makesSense(const SitePacket& packet) noexcept {
  const HeightGrid& grid = packet.grid;
  return packet.robot_connection != 0 && std::abs(grid.x_m) <= kFurthest_m && std::abs(grid.y_m) <= kFurthest_m &&
         grid.cell_m >= kSmallestCell_m && grid.cell_m <= kLargestCell_m && grid.cells() <= SitePacket::kMostCells &&
         isPart(packet.column, packet.columns, grid.columns) && isPart(packet.row, packet.rows, grid.rows);
}

}  // namespace

std::optional<SitePacket> parseSite(std::span<const std::uint8_t> bytes) {
  PacketReader reader(std::as_bytes(bytes));
  if (bytes.size() < SitePacket::kHeaderBytes || !reader.nextIs(SitePacket::kMagic) ||
      reader.next<std::uint16_t>() != SitePacket::kVersion) {
    return std::nullopt;
  }
  SitePacket packet;
  (void)reader.next<std::uint16_t>();
  reader.read(packet.robot_connection);
  packet.grid.columns = reader.next<std::uint16_t>();
  packet.grid.rows = reader.next<std::uint16_t>();
  packet.grid.x_m = static_cast<double>(reader.next<float>());
  packet.grid.y_m = static_cast<double>(reader.next<float>());
  packet.grid.cell_m = static_cast<double>(reader.next<float>());
  packet.column = reader.next<std::uint16_t>();
  packet.row = reader.next<std::uint16_t>();
  packet.columns = reader.next<std::uint16_t>();
  packet.rows = reader.next<std::uint16_t>();
  (void)reader.next<std::uint32_t>();
  reader.read(packet.number);
  reader.read(packet.index);
  const std::size_t cells = packet.columns * packet.rows;
  if (!makesSense(packet) || bytes.size() != SitePacket::kHeaderBytes + cells * sizeof(std::int16_t)) {
    return std::nullopt;
  }
  packet.steps.resize(cells);
  for (std::int16_t& step : packet.steps) {
    reader.read(step);
  }
  return packet;
}

Packet bytesOf(const SitePacket& packet) {
  Packet bytes(SitePacket::kHeaderBytes + packet.steps.size() * sizeof(std::int16_t));
  PacketWriter writer(std::as_writable_bytes(std::span(bytes)));
  const auto count = [&](std::size_t number) { writer.write(static_cast<std::uint16_t>(number)); };
  writer.writeMagic(SitePacket::kMagic);
  writer.write(SitePacket::kVersion);
  count(0);
  writer.write(packet.robot_connection);
  count(packet.grid.columns);
  count(packet.grid.rows);
  writer.write(static_cast<float>(packet.grid.x_m));
  writer.write(static_cast<float>(packet.grid.y_m));
  writer.write(static_cast<float>(packet.grid.cell_m));
  count(packet.column);
  count(packet.row);
  count(packet.columns);
  count(packet.rows);
  writer.write(std::uint32_t{0});
  writer.write(packet.number);
  writer.write(packet.index);
  for (const std::int16_t step : packet.steps) {
    writer.write(step);
  }
  return bytes;
}

}  // namespace haptolith
