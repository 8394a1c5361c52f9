#pragma once

#include "haptolith/bed/contact_kernel.h"

namespace haptolith {

/// Constants of contacts with pairwise friction, as the kernel, the walls and the tool want them.
struct PairwiseLaw {
  KernelLaw normal;
  float cohesion, two_per_range;  ///< F_c in N; 2 / range in 1/m
  float root_of_gamma;            ///< sqrt(gamma)
  float damping;                  ///< zeta sqrt(2 m): c = damping sqrt(-dF/da) is zeta of a pair's critical damping
  float friction;                 ///< mu_p
  float stiffness;                ///< k_t, N/m
  float tangential_damping;       ///< c_t = damping sqrt(k_t), N s/m
};
[[nodiscard]] PairwiseLaw pairwiseLaw(const SoilParameters& soil);

/// How far touching particles have slid against each other: one vector for each entry of the neighbour list, in m,
/// scene frame, of the particle the list belongs to against its neighbour; 0 where they do not touch.
struct ContactMemory {
  float *x, *y, *z;
};

/// Sums the contact forces of particles first..last-1, friction included, and moves the contact memory on by `dt_s`.
/// Each pair is worked out from both sides, with exactly opposite results. May be called in the tick; parts of one bed
/// may be summed by several threads at once.
void sumPairwiseContacts(const PairwiseLaw& law, const Periods& periods, float dt_s, const Float4* position,
                         const Float4* velocity, const Neighbours& neighbours, const ContactMemory& memory,
                         std::size_t first, std::size_t last, ContactSum* sums) noexcept;

/// Brings the memory of one neighbour list over to another list of the same bed: `to` must be zero and is filled.
void carryMemory(const Neighbours& from_list, const ContactMemory& from, const Neighbours& to_list,
                 const ContactMemory& to, std::size_t particles) noexcept;

}  // namespace haptolith
