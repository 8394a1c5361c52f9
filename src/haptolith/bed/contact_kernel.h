#pragma once

#include <cstddef>
#include <cstdint>

#include "haptolith/bed/bed_state.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

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

/// Sums the contact forces of particles first..last-1 with the best instruction set this machine has. May be called in
/// the tick; parts of one bed may be summed by several threads at once.
void sumContacts(const KernelLaw& law, const Float4* position, const std::int32_t* neighbours,
                 const std::uint32_t* begin, std::size_t first, std::size_t last, ContactSum* sums) noexcept;

/// Name of the instruction set in use, for example "AVX3".
[[nodiscard]] const char* simdTarget() noexcept;

/// Particles in order of the grid's cells.
struct SortedPositions {
  const float *x, *y, *z;
  const std::int32_t* particle;
};

/// Writes those of the sorted particles from..to-1 that lie within `reach_m` of particle `self` to `out` and returns how
/// many they are. `out` needs room for to - from and one vector more. May be called in the tick.
std::uint32_t appendNeighbours(const SortedPositions& sorted, std::uint32_t from, std::uint32_t to, const Float4& centre,
                               std::int32_t self, float reach_m, std::int32_t* out) noexcept;

}  // namespace haptolith
