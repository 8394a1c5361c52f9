#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/teleop/link/site_packet.h"

namespace haptolith {

/// The operator's map of a robot's site: the newest data of each part, in any order of packets.
/// Heights are over the site's zero.
class SiteMap {
 public:
  /// Returns false when its data are newer. Another robot, or another map, starts again.
  bool take(const SitePacket& packet);

  [[nodiscard]] bool empty() const noexcept { return heights_m_.empty(); }
  [[nodiscard]] const HeightGrid& grid() const noexcept { return grid_; }
  /// Row by row, in m; NaN: not known.
  [[nodiscard]] const std::vector<double>& heights() const noexcept { return heights_m_; }
  /// Command that the robot had come to when it saw each cell.
  [[nodiscard]] const std::vector<std::uint64_t>& commands() const noexcept { return commands_; }
  /// Number of taken packets: it changes when the map may have changed.
  [[nodiscard]] std::uint64_t taken() const noexcept { return taken_; }

 private:
  std::uint32_t robot_session_ = 0;
  HeightGrid grid_;
  std::vector<double> heights_m_;
  std::vector<bool> known_;             ///< cells covered by a packet, even if they were not seen
  std::vector<std::uint64_t> numbers_;  ///< number of that packet
  std::vector<std::uint64_t> commands_;
  std::uint64_t taken_ = 0;
};

}  // namespace haptolith
