#pragma once

#include <cstdint>
#include <vector>

#include "haptolith/bed/bed_state.h"
#include "haptolith/bed/contact_kernel.h"

namespace haptolith {

/// Who may touch whom until somebody has moved by half the skin: a full list (each pair from both sides), so that every
/// particle sums its own forces in a fixed order, whoever computes it.
///
/// Built from a grid of cells in O(n). Storage is reserved once; build() does not allocate.
class NeighbourList {
 public:
  /// @param reach_m  largest distance of a listed pair: the law's cutoff plus the skin.
  /// @param width_m, length_m  the box, for the size of the grid only; particles outside are found all the same.
  NeighbourList(std::size_t particles, double reach_m, double width_m, double length_m);
  NeighbourList(const NeighbourList&) = delete;
  NeighbourList& operator=(const NeighbourList&) = delete;

  /// Lists all pairs closer than the reach. Returns false when they do not fit: the bed has collapsed onto itself.
  /// May be called in the tick.
  [[nodiscard]] bool build(const std::vector<Float4>& position) noexcept;

  /// The list as the kernel wants it. Of particle i: indices from begin(i) to end(i), a multiple of kNeighbourBlock,
  /// the last ones the ghost (index n).
  [[nodiscard]] const Neighbours& view() const noexcept { return view_; }
  [[nodiscard]] const std::int32_t* indices() const noexcept { return indices_.data(); }
  [[nodiscard]] std::uint32_t begin(std::size_t i) const noexcept { return begin_[i]; }
  [[nodiscard]] std::uint32_t end(std::size_t i) const noexcept { return end_[i]; }

 private:
  void sortIntoCells(const std::vector<Float4>& position) noexcept;

  std::size_t particles_;
  float reach_m_;
  float cells_per_m_;
  float origin_x_m_, origin_y_m_;
  int nx_, ny_, nz_;
  std::vector<std::uint32_t> cell_begin_;  // nx * ny * nz + 1, x fastest: three cells side by side are one range
  std::vector<std::uint32_t> cell_of_;
  std::vector<float> x_, y_, z_;                 // positions in order of cells, padded by one block
  std::vector<std::int32_t> particle_at_;        // which particle stands there
  std::vector<float> near_x_, near_y_, near_z_;  // scratch: the particles of 27 cells
  std::vector<std::int32_t> near_particle_;
  std::vector<std::uint32_t> begin_, end_;
  std::vector<std::int32_t> indices_;
  Neighbours view_{};
};

}  // namespace haptolith
