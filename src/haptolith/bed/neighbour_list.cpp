#include "haptolith/bed/neighbour_list.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "haptolith/bed/contact_kernel.h"

namespace haptolith {

namespace {

// On average a particle of a close packing has 12 neighbours in contact and 6 more within reach: two blocks. The list
// has room for six blocks each, and for all pairs of a small bed however it collapses.
constexpr std::size_t kBlocksPerParticle = 6;

std::size_t capacityFor(std::size_t particles) {
  constexpr std::size_t kBlock = kNeighbourBlock;
  const std::size_t all_blocks = (particles + kBlock - 1) / kBlock + 1;
  return particles * kBlock * std::min(all_blocks, kBlocksPerParticle) + particles + 3 * kBlock;
}

/// Where in the box a place is that may be some periods away; without a period it is where it is.
float intoBox(float metres, float period, float per_period) {
  return metres - period * std::floor(metres * per_period);
}

}  // namespace

NeighbourList::NeighbourList(std::size_t particles, double reach_m, double width_m, double length_m,
                             const Periods& periods)
    : particles_(particles), reach_m_(static_cast<float>(reach_m)), periods_(periods) {
  // Cells of one reach; a little more, so that rounding never puts a neighbour two cells away. Never many more cells
  // than particles: a coarser grid is slower but right.
  const double floor_cells = std::max(1.0, width_m * length_m / (reach_m * reach_m));
  const double coarser = std::max(1.0, std::sqrt(floor_cells / (static_cast<double>(particles) + 64)));
  const double cell_m = reach_m * 1.0001 * coarser;
  // A whole number of cells fits a period exactly, so they are a little larger.
  const auto cells = [cell_m](double length, bool periodic) {
    return periodic ? std::max(3, static_cast<int>(std::floor(length / cell_m)))
                    : std::max(1, static_cast<int>(std::ceil(length / cell_m)));
  };
  nx_ = cells(width_m, periods.width > 0);
  ny_ = cells(length_m, periods.length > 0);
  nz_ = static_cast<int>(std::clamp(2.0 * static_cast<double>(particles) / (nx_ * ny_), 1.0, 1000.0)) + 2;
  cells_per_m_ = static_cast<float>(1 / cell_m);
  cells_per_m_x_ = periods.width > 0 ? static_cast<float>(nx_ / width_m) : cells_per_m_;
  cells_per_m_y_ = periods.length > 0 ? static_cast<float>(ny_ / length_m) : cells_per_m_;
  origin_x_m_ = static_cast<float>(-width_m / 2);
  origin_y_m_ = static_cast<float>(-length_m / 2);

  cell_begin_.resize(static_cast<std::size_t>(nx_) * ny_ * nz_ + 1);
  cell_of_.resize(particles);
  for (std::vector<float>* array : {&x_, &y_, &z_, &near_x_, &near_y_, &near_z_}) {
    array->resize(particles + kNeighbourBlock);
  }
  particle_at_.resize(particles + kNeighbourBlock);
  near_particle_.resize(particles + kNeighbourBlock);
  const auto list = [particles](Storage& storage) {
    storage.begin.resize(particles);
    storage.end.resize(particles);
    storage.indices.resize(capacityFor(particles));
    return Neighbours{storage.indices.data(), storage.begin.data(), storage.end.data(),
                      static_cast<std::int32_t>(particles)};
  };
  view_ = list(now_);
  previous_ = list(before_);
}

void NeighbourList::sortIntoCells(const std::vector<Float4>& position) noexcept {
  // Positions beyond the grid count into its outermost cells: that never pulls two neighbours further apart.
  const auto cell = [](float metres, float cells_per_m, int cells) {
    const float index = metres * cells_per_m;
    return static_cast<int>(std::clamp(index, 0.0F, static_cast<float>(cells - 1)));
  };
  std::fill(cell_begin_.begin(), cell_begin_.end(), 0U);
  for (std::size_t i = 0; i < particles_; ++i) {
    const Float4& p = position[i];
    const int ix = cell(intoBox(p.x - origin_x_m_, periods_.width, periods_.per_width), cells_per_m_x_, nx_);
    const int iy = cell(intoBox(p.y - origin_y_m_, periods_.length, periods_.per_length), cells_per_m_y_, ny_);
    const int iz = cell(p.z, cells_per_m_, nz_);
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
  const CellGrid grid{x_.data(), y_.data(), z_.data(), particle_at_.data(), cell_begin_.data(),
                      nx_,       ny_,       nz_,       periods_.width > 0,  periods_.length > 0};
  const Candidates candidates{near_x_.data(), near_y_.data(), near_z_.data(), near_particle_.data()};
  std::swap(view_, previous_);
  slots_ = listNeighbours(grid, candidates, periods_, position.data(), reach_m_, capacity(), view_);
  return slots_ != kTooMany;
}

}  // namespace haptolith
