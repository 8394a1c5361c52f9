#pragma once

#include <cstddef>
#include <cstdint>
#include <future>
#include <optional>
#include <vector>

#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/core/process/async.h"
#include "haptolith/teleop/link/site_packet.h"

namespace haptolith {

/// A simulated camera above a robot's site: captures its soil at 4 Hz, and sends changed parts
/// first, then those sent longest ago, so that lost parts are repeated.
class SiteCamera {
 public:
  /// @param surface_m  height of the soil's surface in the scene: the site frame's zero.
  /// @param period_s   between two packets.
  SiteCamera(const Bed& bed, double surface_m, double period_s, double tick_s, Work work = Work::kAtOnce);

  /// After each tick of the robot, whose last executed command is `index`: the packet that is due, without a
  /// connection. Capturing takes a few milliseconds, on a separate thread except for a copy.
  [[nodiscard]] std::optional<SitePacket> tick(std::uint64_t index);

  [[nodiscard]] const HeightGrid& grid() const noexcept { return grid_; }
  /// As it was last seen, over the site's zero.
  [[nodiscard]] const std::vector<double>& heights() const noexcept { return heights_m_; }
  /// Number of captures.
  [[nodiscard]] std::uint64_t looks() const noexcept { return looks_; }

 private:
  struct Part {
    std::size_t column, row, columns, rows;
    std::uint64_t number = 0;  ///< number of the packet that sent it last
    bool changed = true;       ///< since then
    std::vector<std::int16_t> told;
  };
  struct Look {
    std::uint64_t index = 0;
    std::vector<double> heights_m;
  };
  void see(Look look);
  [[nodiscard]] SitePacket packetOf(Part& part);
  [[nodiscard]] std::vector<std::int16_t> stepsOf(const Part& part) const;

  const Bed& bed_;
  double surface_m_;
  HeightGrid grid_;
  std::uint64_t look_ticks_, packet_ticks_, tick_ = 0;
  Work work_;
  std::future<Look> coming_;
  std::vector<Part> parts_;
  std::vector<double> heights_m_;
  std::uint64_t looks_ = 0, number_ = 0, index_ = 0;
};

}  // namespace haptolith
