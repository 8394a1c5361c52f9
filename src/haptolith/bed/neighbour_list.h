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
  /// @param periods  of the box, at least three reaches each, or 0.
  NeighbourList(std::size_t particles, double reach_m, double width_m, double length_m, const Periods& periods = {});
  NeighbourList(const NeighbourList&) = delete;
  NeighbourList& operator=(const NeighbourList&) = delete;

  /// Lists all pairs closer than the reach. Returns false when they do not fit: the bed has collapsed onto itself.
  /// May be called in the tick.
  [[nodiscard]] bool build(const std::vector<Float4>& position) noexcept;

  /// The list as the kernel wants it. Of particle i: indices from begin(i) to end(i), a multiple of kNeighbourBlock,
  /// the last ones the ghost (index n).
  [[nodiscard]] const Neighbours& view() const noexcept { return view_; }

  /// The list before the last build().
  [[nodiscard]] const Neighbours& previous() const noexcept { return previous_; }

  /// Number of entries in use, ghosts included, and how many there is room for.
  [[nodiscard]] std::size_t slots() const noexcept { return slots_; }
  [[nodiscard]] std::size_t capacity() const noexcept { return now_.indices.size(); }
  [[nodiscard]] const std::int32_t* indices() const noexcept { return view_.index; }
  [[nodiscard]] std::uint32_t begin(std::size_t i) const noexcept { return view_.begin[i]; }
  [[nodiscard]] std::uint32_t end(std::size_t i) const noexcept { return view_.end[i]; }

 private:
  void sortIntoCells(const std::vector<Float4>& position) noexcept;

  std::size_t particles_;
  float reach_m_;
  float cells_per_m_, cells_per_m_x_, cells_per_m_y_;
  float origin_x_m_, origin_y_m_;
  Periods periods_;
  int nx_, ny_, nz_;
  std::vector<std::uint32_t> cell_begin_;  // nx * ny * nz + 1, x fastest: three cells side by side are one range
  std::vector<std::uint32_t> cell_of_;
  std::vector<float> x_, y_, z_;                 // positions in order of cells, padded by one block
  std::vector<std::int32_t> particle_at_;        // which particle stands there
  std::vector<float> near_x_, near_y_, near_z_;  // scratch: the particles of 27 cells
  std::vector<std::int32_t> near_particle_;
  struct Storage {
    std::vector<std::uint32_t> begin, end;
    std::vector<std::int32_t> indices;
  };
  Storage now_, before_;
  Neighbours view_{}, previous_{};
  std::size_t slots_ = 0;
};

}  // namespace haptolith
