#include "haptolith/teleop/robot/site_camera.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace haptolith {

namespace {

constexpr double kLook_s = 0.25;
constexpr double kMostAlongSide = 64;  ///< cells
constexpr int kChanged_steps = 3;      ///< a camera sees no less

double cellOf(const BedParameters& bed) {
  return std::max(2 * bed.soil.radius_m, std::max(bed.width_m, bed.length_m) / kMostAlongSide);
}

/// Four to a grain's width.
std::size_t raysOf(const SeenSoil& seen, const HeightGrid& grid) {
  return static_cast<std::size_t>(std::max(1.0, std::round(2 * grid.cell_m / seen.radius_m)));
}

std::uint64_t ticksIn(double time_s, double tick_s) {
  return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(time_s / tick_s)));
}

}  // namespace

SiteCamera::SiteCamera(const Bed& bed, double surface_m, double period_s, double tick_s, Work work)
    : bed_(bed),
      surface_m_(surface_m),
      grid_(gridWithinSides(bed.parameters(), cellOf(bed.parameters()))),
      look_ticks_(ticksIn(kLook_s, tick_s)),
      packet_ticks_(ticksIn(period_s, tick_s)),
      work_(work) {
  for (std::size_t row = 0; row < grid_.rows; row += SitePacket::kSide) {
    for (std::size_t column = 0; column < grid_.columns; column += SitePacket::kSide) {
      parts_.push_back({column,
                        row,
                        std::min(SitePacket::kSide, grid_.columns - column),
                        std::min(SitePacket::kSide, grid_.rows - row),
                        0,
                        true,
                        {}});
    }
  }
}

std::optional<SitePacket> SiteCamera::tick(std::uint64_t index) {
  if (tick_ % look_ticks_ == 0 && !coming_.valid()) {
    coming_ = setOut(work_, [seen = seenSoil(bed_), grid = grid_, index] {
      return Look{index, surfaceHeights(seen, grid, raysOf(seen, grid))};
    });
  }
  if (isThere(coming_)) {
    see(coming_.get());
  }
  if (tick_++ % packet_ticks_ != 0 || looks_ == 0) {
    return std::nullopt;
  }
  return packetOf(
      *std::ranges::min_element(parts_, {}, [](const Part& part) { return std::pair(!part.changed, part.number); }));
}

void SiteCamera::see(Look look) {
  heights_m_ = std::move(look.heights_m);
  for (double& height_m : heights_m_) {
    height_m -= surface_m_;
  }
  index_ = look.index;
  ++looks_;
  for (Part& part : parts_) {
    const std::vector<std::int16_t> steps = stepsOf(part);
    part.changed = part.changed || !std::ranges::equal(steps, part.told, [](int now, int told) {
                     return std::abs(now - told) < kChanged_steps;
                   });
  }
}

SitePacket SiteCamera::packetOf(Part& part) {
  part.number = ++number_;
  part.changed = false;
  part.told = stepsOf(part);
  return {0, grid_, part.column, part.row, part.columns, part.rows, number_, index_, part.told};
}

std::vector<std::int16_t> SiteCamera::stepsOf(const Part& part) const {
  std::vector<std::int16_t> steps;
  steps.reserve(part.columns * part.rows);
  for (std::size_t row = part.row; row < part.row + part.rows; ++row) {
    for (std::size_t column = part.column; column < part.column + part.columns; ++column) {
      constexpr double kMost = 32767;
      steps.push_back(static_cast<std::int16_t>(
          std::clamp(std::round(heights_m_[row * grid_.columns + column] / SitePacket::kStep_m), -kMost, kMost)));
    }
  }
  return steps;
}

}  // namespace haptolith
