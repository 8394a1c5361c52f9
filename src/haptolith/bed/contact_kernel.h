#pragma once

#include <cstddef>
#include <cstdint>

#include "haptolith/bed/bed_state.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

/// Neighbours of a particle fill whole blocks of this many: one AVX-512 vector, two of AVX2, four of SSE4 or NEON.
constexpr std::uint32_t kNeighbourBlock = 16;

/// What a particle feels of its neighbours.
struct alignas(16) ContactSum {
  float force_x_n = 0, force_y_n = 0, force_z_n = 0;
  float repulsion_n = 0;  ///< sum of the magnitudes of repulsive contact forces, for friction (paper 14)
  float contacts = 0;     ///< p, number of macroparticles that overlap this one, for damping (paper 20)
  float unused[3] = {};
};

/// The law's constants as the kernel wants them.
struct KernelLaw {
  float gamma, a_min, a_thr, h, k, cutoff, diameter;
};
[[nodiscard]] KernelLaw kernelLaw(const ContactLaw& law, double radius_m);

/// How often the box repeats itself, for beds that have periods instead of walls; 0 along an axis that has walls.
struct Periods {
  float width = 0, length = 0;          ///< m, along x and y
  float per_width = 0, per_length = 0;  ///< 1 / width and 1 / length, or 0

  [[nodiscard]] bool any() const noexcept { return width > 0 || length > 0; }
};

/// Who is near whom: particle i's neighbours are index[begin[i]] to index[end[i] - 1], whole blocks, the last one
/// filled up with the ghost.
struct Neighbours {
  std::int32_t* index;
  std::uint32_t *begin, *end;
  std::int32_t ghost;
};

/// Sums the contact forces of particles first..last-1 with the best instruction set this machine has. May be called in
/// the tick; parts of one bed may be summed by several threads at once.
void sumContacts(const KernelLaw& law, const Periods& periods, const Float4* position, const Neighbours& neighbours,
                 std::size_t first, std::size_t last, ContactSum* sums) noexcept;

/// Name of the instruction set in use, for example "AVX3".
[[nodiscard]] const char* simdTarget() noexcept;

/// Particles sorted into cells no smaller than the reach, x fastest, so that three cells side by side are one range.
struct CellGrid {
  const float *x, *y, *z;           ///< positions in the cells' order, readable one block beyond the last
  const std::int32_t* particle;     ///< who stands there
  const std::uint32_t* cell_begin;  ///< nx * ny * nz + 1 entries
  int nx, ny, nz;
  bool periodic_x, periodic_y;  ///< the last cell of a row stands beside the first
};

/// Scratch for the particles of 27 cells: room for all particles and one block.
struct Candidates {
  float *x, *y, *z;
  std::int32_t* particle;
};

/// What listNeighbours() returns when they do not fit.
inline constexpr std::size_t kTooMany = ~std::size_t{0};

/// Lists for each particle all others within `reach_m`. Returns how many entries that takes, kTooMany when `capacity`
/// (of index) is too small. May be called in the tick.
[[nodiscard]] std::size_t listNeighbours(const CellGrid& grid, const Candidates& candidates, const Periods& periods,
                                         const Float4* position, float reach_m, std::size_t capacity,
                                         const Neighbours& neighbours) noexcept;

}  // namespace haptolith
