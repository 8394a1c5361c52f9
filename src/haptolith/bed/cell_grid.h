#pragma once

#include <cstdint>
#include <vector>

#include "haptolith/bed/bed_state.h"
#include "haptolith/bed/kernel/kernel_law.h"

namespace haptolith {

/// A box and the initial height of its soil.
struct GridBox {
  double width_m = 0, length_m = 0;  ///< for the size of the grid only; particles outside are found all the same
  double height_m = 0;
  Periods periods;  ///< at least three cells each, or 0
};

/// Which particle is where: cells as wide as the reach, so that all within reach of a particle stand in its
/// cell or one of the 26 around it. Particles come and go one by one, in constant time. Nothing allocates after
/// construction.
class CellGrid {
 public:
  CellGrid(std::size_t particles, double cell_m, const GridBox& box);

  [[nodiscard]] std::uint32_t cellOf(const Float4& position) const noexcept;
  void insert(std::int32_t particle, std::uint32_t cell) noexcept;
  void remove(std::int32_t particle, std::uint32_t cell) noexcept;
  void clear() noexcept;

  /// Writes the particles of a cell and of the 26 around it to `out`, which has room for candidatesAtMost(), and
  /// returns how many. Their order is whatever it is.
  [[nodiscard]] std::uint32_t candidates(std::uint32_t cell, std::int32_t* out) const noexcept;
  [[nodiscard]] std::size_t candidatesAtMost() const noexcept { return 28 * kCellRoom + spilled_.size(); }

  /// As above for all cells within `reach_m` of a place along each axis, for reaches wider than a cell.
  [[nodiscard]] std::uint32_t candidatesWithin(const Float4& place, float reach_m, std::int32_t* out) const noexcept;
  [[nodiscard]] std::size_t candidatesAtMost(float reach_m) const noexcept;

  /// Cells from one to another, along each axis.
  struct Block {
    struct Place {
      int x, y, z;
      bool operator==(const Place&) const = default;
    } from, to;
    bool operator==(const Block&) const = default;
  };
  /// The cells that a box from `low` to `high` touches.
  [[nodiscard]] Block blockOf(const Float4& low, const Float4& high) const noexcept {
    return {placeOf(low), placeOf(high)};
  }
  /// Calls `each(particle)` for all particles of these cells, and maybe others: all along an axis that repeats itself.
  template <class Each>
  void forEachIn(const Block& block, Each each) const noexcept;

  [[nodiscard]] std::size_t cells() const noexcept { return count_.size(); }
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  /// More than fit into a cell's volume unless they are pressed together by half; the rest is spilled.
  static constexpr std::size_t kCellRoom = 16;

  using Place = Block::Place;
  [[nodiscard]] Place placeOf(const Float4& position) const noexcept;
  [[nodiscard]] std::uint32_t number(const Place& place) const noexcept {
    return static_cast<std::uint32_t>((place.z * ny_ + place.y) * nx_ + place.x);
  }

  Periods periods_;
  float cells_per_m_x_, cells_per_m_y_, cells_per_m_z_;
  float origin_x_m_, origin_y_m_;
  int nx_, ny_, nz_;
  std::vector<std::int32_t, CacheAligned<std::int32_t>> particle_;  // kCellRoom for each cell
  std::vector<std::uint8_t> count_;                                 // of particles in each cell
  std::vector<std::int32_t> spilled_;                               // that found their cell full
  std::size_t spilled_count_ = 0;
};

template <class Each>
void CellGrid::forEachIn(const Block& block, Each each) const noexcept {
  const bool wraps_x = periods_.width > 0;
  const bool wraps_y = periods_.length > 0;
  const auto& [from, to] = block;
  for (int z = from.z; z <= to.z; ++z) {
    for (int y = wraps_y ? 0 : from.y; y <= (wraps_y ? ny_ - 1 : to.y); ++y) {
      for (int x = wraps_x ? 0 : from.x; x <= (wraps_x ? nx_ - 1 : to.x); ++x) {
        const std::uint32_t cell = number({x, y, z});
        for (std::size_t i = 0; i < count_[cell]; ++i) {
          each(particle_[cell * kCellRoom + i]);
        }
      }
    }
  }
  for (std::size_t i = 0; i < spilled_count_; ++i) {
    each(spilled_[i]);
  }
}

}  // namespace haptolith
