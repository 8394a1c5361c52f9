#pragma once

#include <cstdint>

#include "haptolith/bed/bed_state.h"

namespace haptolith {

/// Walls as bits of StepArrays::near_walls. Only the nearer one of two opposite walls is in reach.
enum WallBit : std::uint8_t { kFloor = 1, kWallX = 2, kWallY = 4 };

/// Arrays that a step reads and writes: G groups of kGroup entries, N = kGroup G in all, of which those after the
/// particles are ghosts, R rows of kGroup entries in the contact lists' pool.
struct StepArrays {
  // Read. Which groups are stepped:
  const std::uint32_t* groups;  ///< those to step, and one number more behind the last; null: all G
  bool beyond_cache;            ///< whether they are so many that prefetching neighbours pays; only with `groups`

  // Read. Particles:
  const Float4 *position, *velocity;  ///< [N] m, m/s
  const Float4* external;             ///< [N] forces of tool and stones, N
  const Float4* reference_position;   ///< [N] where each was when its list was built, m: see Neighbourhood
  const std::uint8_t* grain_class;    ///< [G]; null: all of the coarsest (contact friction only)

  // Read. Contact lists, as in ContactLists:
  const std::uint32_t* other;      ///< [R][kGroup] offset of each neighbour in `position`, bytes
  const std::uint32_t* first_row;  ///< [G + 1] of each group's rows
  const std::uint16_t* rows;       ///< [G] how many rows each has

  // Read and written.
  float* slip;               ///< [R][3][kGroup] x, y and z of each entry's slip, m
  QuarterRows* touched;      ///< [G] rows behind which no entry remembers anything
  InnerRows* inner;          ///< [G] rows of the inner lists; null: none, all rows are computed
  Float4* remainder;         ///< [N] BedState::remainder; null: none
  WallSlips* wall_slip;      ///< [G] contact friction only
  std::uint8_t* near_walls;  ///< [G] WallBits; a clear bit means that all slips at that wall are 0

  // Written.
  Float4 *next_position, *next_velocity;  ///< [N]
  Float4* contact_force;                  ///< [N] of the neighbours on each particle, N; null: not kept
  std::uint8_t* moving;                   ///< [G] whether any of its particles is not at rest
};

}  // namespace haptolith
