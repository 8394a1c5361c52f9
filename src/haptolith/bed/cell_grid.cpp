#include "haptolith/bed/cell_grid.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "haptolith/core/assert.h"

namespace haptolith {

namespace {

/// Maps a coordinate into a periodic box; without a period it is unchanged.
float intoBox(float metres, float period, float per_period) {
  return metres - period * std::floor(metres * per_period);
}

/// Number of cells of at least `cell_m` that fit into `length_m`.
int cellsIn(double length_m, double cell_m, double most) {
  return static_cast<int>(std::clamp(std::floor(length_m / cell_m), 1.0, std::max(1.0, most)));
}

/// A number of cells that an int holds, whatever it is: NaN becomes `low`.
float bounded(float cells, float low, float high) {
  return cells > low ? std::min(cells, high) : low;
}

/// Positions beyond the grid count into its outermost cells: that never pulls two neighbours further apart. One that is
/// not a number, which the next check of the bed refuses, counts into the first.
int indexOf(float metres, float cells_per_m, int cells) {
  return static_cast<int>(bounded(metres * cells_per_m, 0, static_cast<float>(cells - 1)));
}

}  // namespace

CellGrid::CellGrid(std::size_t particles, double cell_m, const GridBox& box)
    : periods_(box.periods),
      origin_x_m_(static_cast<float>(-box.width_m / 2)),
      origin_y_m_(static_cast<float>(-box.length_m / 2)),
      spilled_(particles) {
  // No more cells than make sense for so few particles, in a box however large.
  const auto n = static_cast<double>(particles);
  const double most_sideways = 4 * n + 64;
  nx_ = cellsIn(box.width_m, cell_m, most_sideways);
  ny_ = cellsIn(box.length_m, cell_m, most_sideways);
  while (static_cast<double>(nx_) * ny_ > most_sideways) {
    int& more = nx_ > ny_ ? nx_ : ny_;
    more = (more + 1) / 2;
  }
  constexpr double kRoomAbove = 4;  // cells; particles above are in the topmost one
  nz_ = cellsIn(box.height_m + kRoomAbove * cell_m, cell_m, (8 * n + 4096) / (static_cast<double>(nx_) * ny_));
  cells_per_m_x_ = static_cast<float>(nx_ / std::max(box.width_m, nx_ * cell_m));
  cells_per_m_y_ = static_cast<float>(ny_ / std::max(box.length_m, ny_ * cell_m));
  cells_per_m_z_ = static_cast<float>(1 / cell_m);
  const std::size_t cells =
      static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_) * static_cast<std::size_t>(nz_);
  particle_.resize(cells * kCellRoom);
  count_.resize(cells);
}

CellGrid::Place CellGrid::placeOf(const Float4& p) const noexcept {
  return {indexOf(intoBox(p.x - origin_x_m_, periods_.width, periods_.per_width), cells_per_m_x_, nx_),
          indexOf(intoBox(p.y - origin_y_m_, periods_.length, periods_.per_length), cells_per_m_y_, ny_),
          indexOf(p.z, cells_per_m_z_, nz_)};
}

std::uint32_t CellGrid::cellOf(const Float4& position) const noexcept {
  return number(placeOf(position));
}

void CellGrid::insert(std::int32_t particle, std::uint32_t cell) noexcept {
  HAPTO_ASSERT(cell < count_.size());
  HAPTO_ASSERT(particle >= 0 && static_cast<std::size_t>(particle) < spilled_.size());
  HAPTO_ASSERT(count_[cell] < kCellRoom || spilled_count_ < spilled_.size());
  if (count_[cell] < kCellRoom) {
    particle_[cell * kCellRoom + count_[cell]++] = particle;
  } else {
    spilled_[spilled_count_++] = particle;
  }
}

void CellGrid::remove(std::int32_t particle, std::uint32_t cell) noexcept {
  HAPTO_ASSERT(cell < count_.size());
  std::int32_t* begin = particle_.data() + cell * kCellRoom;
  std::int32_t* end = begin + count_[cell];
  if (std::int32_t* found = std::find(begin, end, particle); found != end) {
    *found = end[-1];
    --count_[cell];
    return;
  }
  const auto spilled_end = spilled_.begin() + static_cast<std::ptrdiff_t>(spilled_count_);
  if (const auto found = std::find(spilled_.begin(), spilled_end, particle); found != spilled_end) {
    *found = spilled_end[-1];
    --spilled_count_;
  }
}

void CellGrid::clear() noexcept {
  std::ranges::fill(count_, std::uint8_t{0});
  spilled_count_ = 0;
}

std::uint32_t CellGrid::candidates(std::uint32_t cell, std::int32_t* out) const noexcept {
  HAPTO_ASSERT(cell < count_.size());
  const auto nx = static_cast<std::uint32_t>(nx_);
  const auto ny = static_cast<std::uint32_t>(ny_);
  const Place at{static_cast<int>(cell % nx), static_cast<int>(cell / nx % ny), static_cast<int>(cell / nx / ny)};
  // Side by side, an axis that repeats itself has three different cells; one with walls has no cell beyond its ends.
  struct Span {
    int cells[3]{};
    int count = 0;
  };
  const auto around = [](int middle, int cells, bool wraps) {
    Span span;
    for (int i = middle - 1; i <= middle + 1; ++i) {
      if (wraps || (i >= 0 && i < cells)) {
        span.cells[span.count++] = (i + cells) % cells;
      }
    }
    return span;
  };
  const Span xs = around(at.x, nx_, periods_.width > 0);
  const Span ys = around(at.y, ny_, periods_.length > 0);
  const Span zs = around(at.z, nz_, false);
  std::uint32_t found = 0;
  for (int z = 0; z < zs.count; ++z) {
    for (int y = 0; y < ys.count; ++y) {
      for (int x = 0; x < xs.count; ++x) {
        const std::uint32_t near = number({xs.cells[x], ys.cells[y], zs.cells[z]});
        std::memcpy(out + found, particle_.data() + near * kCellRoom, kCellRoom * sizeof(std::int32_t));
        found += count_[near];  // surplus copies are overwritten next
      }
    }
  }
  std::copy_n(spilled_.begin(), spilled_count_, out + found);
  return found + static_cast<std::uint32_t>(spilled_count_);
}

namespace {

/// Cells first to first + count - 1 of an axis; a periodic axis continues from its beginning.
struct CellSpan {
  int first, count;
};
CellSpan within(float middle, float reach, float cells_per_m, int cells, bool wraps) {
  const auto cell_at = [=](float metres) {
    const auto once_around = static_cast<float>(cells);
    return static_cast<int>(bounded(std::floor(metres * cells_per_m), -once_around, 2 * once_around));
  };
  const int first = cell_at(middle - reach);
  const int last = cell_at(middle + reach);
  if (wraps) {
    return last - first + 1 >= cells ? CellSpan{0, cells} : CellSpan{(first + cells) % cells, last - first + 1};
  }
  const int from = std::clamp(first, 0, cells - 1);
  return {from, std::clamp(last, 0, cells - 1) - from + 1};
}

}  // namespace

std::uint32_t CellGrid::candidatesWithin(const Float4& p, float reach_m, std::int32_t* out) const noexcept {
  HAPTO_ASSERT(reach_m >= 0);
  const CellSpan xs = within(intoBox(p.x - origin_x_m_, periods_.width, periods_.per_width), reach_m, cells_per_m_x_,
                             nx_, periods_.width > 0);
  const CellSpan ys = within(intoBox(p.y - origin_y_m_, periods_.length, periods_.per_length), reach_m, cells_per_m_y_,
                             ny_, periods_.length > 0);
  const CellSpan zs = within(p.z, reach_m, cells_per_m_z_, nz_, false);
  std::uint32_t found = 0;
  for (int z = zs.first; z < zs.first + zs.count; ++z) {
    for (int y = ys.first; y < ys.first + ys.count; ++y) {
      for (int x = xs.first; x < xs.first + xs.count; ++x) {
        const std::uint32_t near = number({x % nx_, y % ny_, z});
        std::memcpy(out + found, particle_.data() + near * kCellRoom, kCellRoom * sizeof(std::int32_t));
        found += count_[near];
      }
    }
  }
  std::copy_n(spilled_.begin(), spilled_count_, out + found);
  return found + static_cast<std::uint32_t>(spilled_count_);
}

std::size_t CellGrid::candidatesAtMost(float reach_m) const noexcept {
  const auto most = [reach_m](float cells_per_m, int cells) {
    return static_cast<std::size_t>(std::min(static_cast<int>(2 * reach_m * cells_per_m) + 3, std::max(cells, 3)));
  };
  return (most(cells_per_m_x_, nx_) * most(cells_per_m_y_, ny_) * most(cells_per_m_z_, nz_) + 1) * kCellRoom +
         spilled_.size();
}

std::size_t CellGrid::bytes() const noexcept {
  return particle_.size() * sizeof(particle_[0]) + count_.size() + spilled_.size() * sizeof(spilled_[0]);
}

}  // namespace haptolith
