#include "haptolith/bed/neighbour_list.h"

#include <algorithm>
#include <cmath>

#include "haptolith/bed/contact_kernel.h"

namespace haptolith {

namespace {

// On average a particle of a close packing has 12 neighbours in contact and 6 more within reach: two blocks. The list has
// room for six blocks each, and for all pairs of a small bed however it collapses.
constexpr std::size_t kBlocksPerParticle = 6;

std::size_t capacityFor(std::size_t particles) {
  constexpr std::size_t block = NeighbourList::kBlock;
  const std::size_t all_blocks = (particles + block - 1) / block + 1;
  return particles * block * std::min(all_blocks, kBlocksPerParticle) + block;
}

}  // namespace

NeighbourList::NeighbourList(std::size_t particles, double reach_m, double width_m, double length_m)
    : particles_(particles), reach_m_(static_cast<float>(reach_m)) {
  // Cells of one reach; a little more, so that rounding never puts a neighbour two cells away. Never many more cells than
  // particles: a coarser grid is slower but right.
  const double floor_cells = std::max(1.0, width_m * length_m / (reach_m * reach_m));
  const double coarser = std::max(1.0, std::sqrt(floor_cells / (static_cast<double>(particles) + 64)));
  const double cell_m = reach_m * 1.0001 * coarser;
  nx_ = std::max(1, static_cast<int>(std::ceil(width_m / cell_m)));
  ny_ = std::max(1, static_cast<int>(std::ceil(length_m / cell_m)));
  nz_ = static_cast<int>(std::clamp(2.0 * static_cast<double>(particles) / (nx_ * ny_), 1.0, 1000.0)) + 2;
  cells_per_m_ = static_cast<float>(1 / cell_m);
  origin_x_m_ = static_cast<float>(-width_m / 2);
  origin_y_m_ = static_cast<float>(-length_m / 2);

  cell_begin_.resize(static_cast<std::size_t>(nx_) * ny_ * nz_ + 1);
  cell_of_.resize(particles);
  x_.resize(particles + kBlock);
  y_.resize(particles + kBlock);
  z_.resize(particles + kBlock);
  particle_at_.resize(particles + kBlock);
  begin_.resize(particles + 1);
  indices_.resize(capacityFor(particles));
}

void NeighbourList::sortIntoCells(const std::vector<Float4>& position) noexcept {
  // Positions beyond the grid count into its outermost cells: that never pulls two neighbours further apart.
  const auto cell = [this](float metres, float origin, int cells) {
    const float index = (metres - origin) * cells_per_m_;
    return static_cast<int>(std::clamp(index, 0.0F, static_cast<float>(cells - 1)));
  };
  std::fill(cell_begin_.begin(), cell_begin_.end(), 0U);
  for (std::size_t i = 0; i < particles_; ++i) {
    const Float4& p = position[i];
    const int ix = cell(p.x, origin_x_m_, nx_);
    const int iy = cell(p.y, origin_y_m_, ny_);
    const int iz = cell(p.z, 0, nz_);
    cell_of_[i] = static_cast<std::uint32_t>((iz * ny_ + iy) * nx_ + ix);
    ++cell_begin_[cell_of_[i] + 1];
  }
  for (std::size_t c = 1; c < cell_begin_.size(); ++c) {
    cell_begin_[c] += cell_begin_[c - 1];
  }
  for (std::size_t i = particles_; i-- > 0;) {  // backwards from each cell's end keeps the order of indices
    const std::uint32_t slot = --cell_begin_[cell_of_[i] + 1];
    x_[slot] = position[i].x;
    y_[slot] = position[i].y;
    z_[slot] = position[i].z;
    particle_at_[slot] = static_cast<std::int32_t>(i);
  }
  // Each entry c + 1 now holds the begin of cell c: shift back.
  std::copy(cell_begin_.begin() + 1, cell_begin_.end(), cell_begin_.begin());
  cell_begin_.back() = static_cast<std::uint32_t>(particles_);
}

bool NeighbourList::build(const std::vector<Float4>& position) noexcept {
  sortIntoCells(position);
  const SortedPositions sorted{x_.data(), y_.data(), z_.data(), particle_at_.data()};
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < particles_; ++i) {
    begin_[i] = next;
    const int cell = static_cast<int>(cell_of_[i]);
    const int ix = cell % nx_;
    const int iy = cell / nx_ % ny_;
    const int iz = cell / nx_ / ny_;
    const int first_x = std::max(ix - 1, 0);
    const int last_x = std::min(ix + 1, nx_ - 1);
    for (int z = std::max(iz - 1, 0); z <= std::min(iz + 1, nz_ - 1); ++z) {
      for (int y = std::max(iy - 1, 0); y <= std::min(iy + 1, ny_ - 1); ++y) {
        const int row = (z * ny_ + y) * nx_;
        const std::uint32_t from = cell_begin_[row + first_x];
        const std::uint32_t to = cell_begin_[row + last_x + 1];
        if (next + (to - from) + kBlock > indices_.size()) {
          return false;
        }
        next += appendNeighbours(sorted, from, to, position[i], static_cast<std::int32_t>(i), reach_m_,
                                 indices_.data() + next);
      }
    }
    while ((next - begin_[i]) % kBlock != 0) {
      indices_[next++] = static_cast<std::int32_t>(particles_);
    }
  }
  begin_[particles_] = next;
  return true;
}

}  // namespace haptolith
