#pragma once

#include "haptolith/core/vec.h"
#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// Force of a contact with contact friction.
struct ReferencePair {
  Vec3 force_n = Vec3::Zero();  ///< on the first
  double compression_n = 0;     ///< limit of friction, over mu_p
};

/// Computes one contact with contact friction in double precision, from the equations in friction-inl.h: a version that
/// shares nothing with the kernels. Not for the tick.
/// @param towards      unit vector from the second to the first.
/// @param a            distance of their centres in m, less by how much they are larger than the mean.
/// @param velocity     of the first against the second, m/s.
/// @param slip         xi in m, read and written.
/// @param friction_ratio, cohesion_ratio  1, or less at a wall.
[[nodiscard]] ReferencePair referenceContact(const SoilParameters& soil, const Vec3& towards, double a,
                                             const Vec3& velocity, double dt, Vec3& slip, double friction_ratio = 1,
                                             double cohesion_ratio = 1);

}  // namespace haptolith
