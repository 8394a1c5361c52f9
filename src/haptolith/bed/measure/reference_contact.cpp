#include "haptolith/bed/measure/reference_contact.h"

#include <algorithm>
#include <cmath>

#include "haptolith/soil/printed_law.h"

namespace haptolith {

ReferencePair referenceContact(const SoilParameters& soil, const Vec3& towards, double a, const Vec3& velocity,
                               double dt, Vec3& slip, double friction_ratio, double cohesion_ratio) {
  const double diameter = 2 * soil.radius_m;
  const double cohesion = cohesion_ratio * soil.contact_cohesion_n;
  const double range = soil.cohesion_range_ratio * soil.radius_m;
  const double gap = a - diameter;
  if (gap >= (soil.contact_cohesion_n > 0 ? range : 0)) {
    slip.setZero();
    return {};
  }
  const double mass = 4 * std::sqrt(2.0) * soil.rho0_kg_m3 * std::pow(soil.radius_m, 3);
  const double density = soil.rho0_kg_m3 / soil.rho_max_kg_m3;
  const double a_min = diameter / std::sqrt(3.0) * std::sqrt(2 * density * density + 1);

  double normal = gap < 0 ? printedForce(soil, a) : 0;
  double compression = normal;
  if (gap < 0) {
    compression += cohesion;
  } else {
    const double s = gap / range;
    normal -= 4 * cohesion * s * (1 - s);
    compression += s < 0.5 ? cohesion * (1 - 2 * s) * (1 - 2 * s) : 0;
  }
  const double hyperbola_slope = soil.gamma_nm / ((a - a_min) * (a - a_min));
  const double slope = a > a_min ? std::min(hyperbola_slope, soil.stiffness_n_m) : soil.stiffness_n_m;
  const double parting = velocity.dot(towards);
  const double damped = normal - soil.damping_ratio * std::sqrt(2 * mass * slope) * parting;
  const double push = normal > 0 ? std::max(damped, 0.0) : std::max(damped, normal);

  const double k_t = soil.tangential_ratio * soil.stiffness_n_m;
  const double c_t = soil.damping_ratio * std::sqrt(2 * mass * k_t);
  const double limit = friction_ratio * soil.contact_friction * compression;
  const Vec3 sliding = velocity - parting * towards;
  slip += dt * sliding - slip.dot(towards) * towards;
  if (k_t * slip.norm() > limit) {
    slip *= limit / (k_t * slip.norm());
  }
  Vec3 drag = -k_t * slip - c_t * sliding;
  if (drag.norm() > limit) {
    drag *= limit / drag.norm();
  }
  return {push * towards + drag, compression};
}

}  // namespace haptolith
