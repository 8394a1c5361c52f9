#pragma once

#include <cstddef>

#include "haptolith/bed/bed.h"

namespace haptolith {

/// Difference between a step of the kernels and the same step in double precision.
struct StepError {
  double force_n = 0;         ///< root mean square of the contact force on a particle
  double error_n = 0;         ///< root mean square of the difference
  double largest_n = 0;       ///< largest difference
  std::size_t particles = 0;  ///< number of compared particles
};

/// Whether compareWithDouble() knows the laws of a bed: contact friction, one class of particles, no stones.
[[nodiscard]] bool hasDoubleStep(const Bed& bed) noexcept;

/// Steps a copy of a bed once, and computes the forces of that step again with referenceContact(): from the same
/// positions, velocities and friction memory, without the kernels. The differences are those of rounding in a step.
/// Compared are free particles that are awake and touch no wall. The bed must be one of which hasDoubleStep() is true.
/// Not for the tick.
/// @param dt_s  a stable step. @throws Failure when the step fails.
[[nodiscard]] StepError compareWithDouble(const Bed& bed, double dt_s);

}  // namespace haptolith
