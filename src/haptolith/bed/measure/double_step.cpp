#include "haptolith/bed/measure/double_step.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "haptolith/bed/measure/apart.h"
#include "haptolith/bed/measure/reference_contact.h"
#include "haptolith/core/assert.h"
#include "haptolith/core/error.h"

namespace haptolith {

namespace {

Vec3 vec(const Float4& f) {
  return {f.x, f.y, f.z};
}

/// Whether a particle may touch the floor or a wall in this step.
bool isBesideWall(const BedParameters& bed, const Float4& at) {
  const double reach_m = bed.soil.radius_m * (1 + bed.soil.cohesion_range_ratio) + at.w;
  return at.z < reach_m || (!bed.periodic_x && bed.width_m / 2 - std::abs(at.x) < reach_m) ||
         (!bed.periodic_y && bed.length_m / 2 - std::abs(at.y) < reach_m);
}

Vec3 contactForces(const BedParameters& bed, const BedState& state, std::size_t i, double dt_s) {
  Vec3 force_n = Vec3::Zero();
  for (std::uint32_t s = 0; s < state.contacts.count(i); ++s) {
    const auto j = static_cast<std::size_t>(state.contacts.neighbour(i, s));
    if (j >= state.particles()) {
      continue;
    }
    const Float4 &first = state.position[i], &second = state.position[j];
    const Vec3 apart_m = apart(bed, first, second);
    const double distance_m = apart_m.norm();
    const Slip remembered = state.contacts.slip(i, s);
    Vec3 slip_m(remembered.x, remembered.y, remembered.z);
    force_n += referenceContact(bed.soil, apart_m / distance_m, distance_m - first.w - second.w,
                                vec(state.velocity[i]) - vec(state.velocity[j]), dt_s, slip_m)
                   .force_n;
  }
  return force_n;
}

}  // namespace

bool hasDoubleStep(const Bed& bed) noexcept {
  const BedParameters& parameters = bed.parameters();
  return parameters.soil.friction == FrictionModel::kContact && grainClasses(parameters) == 1 &&
         !parameters.stones.any();
}

StepError compareWithDouble(const Bed& bed, double dt_s) {
  HAPTO_ASSERT(hasDoubleStep(bed));
  const BedParameters& parameters = bed.parameters();
  const SavedBed before = bed.save();
  Bed after(parameters, before);
  if (after.step(dt_s) != StepStatus::kOk) {
    throw Failure("a step of the bed failed, so that it cannot be compared with one in double precision");
  }
  const BedState& state = before.state;
  StepError error;
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    if (bed.isDriven(i) || state.asleep(i / kGroup) || isBesideWall(parameters, state.position[i])) {
      continue;
    }
    const Vec3 force_n = contactForces(parameters, state, i, dt_s);
    const Vec3 stepped_m_s = vec(after.state().velocity[i]) - vec(state.velocity[i]);
    const double off_n = (bed.mass() * (stepped_m_s / dt_s - parameters.gravity_m_s2) - force_n).norm();
    error.force_n += force_n.squaredNorm();
    error.error_n += off_n * off_n;
    error.largest_n = std::max(error.largest_n, off_n);
    ++error.particles;
  }
  if (error.particles > 0) {
    error.force_n = std::sqrt(error.force_n / static_cast<double>(error.particles));
    error.error_n = std::sqrt(error.error_n / static_cast<double>(error.particles));
  }
  return error;
}

}  // namespace haptolith
