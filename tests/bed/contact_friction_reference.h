#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "haptolith/core/vec.h"
#include "haptolith/soil/soil_parameters.h"

#include "../printed_law.h"

namespace haptolith {

/// Contacts with contact friction from the words of their docstrings, one pair at a time and in double precision: an
/// independent version.
struct ReferencePair {
  Vec3 force_n = Vec3::Zero();  ///< on the first
  double compression_n = 0;     ///< limit of friction, over mu_p
};

/// @param towards      unit vector from the second to the first.
/// @param a            distance of their centres, less by how much they are larger than the mean.
/// @param velocity     of the first against the second.
/// @param slip         xi, read and written.
/// @param friction_ratio, cohesion_ratio  1, or less at a wall.
inline ReferencePair referenceContact(const SoilParameters& soil, const Vec3& towards, double a, const Vec3& velocity,
                                      double dt, Vec3& slip, double friction_ratio = 1, double cohesion_ratio = 1) {
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

/// Few particles far from all walls but the floor, stepped as Bed says it steps.
class ReferenceBed {
 public:
  SoilParameters soil;
  Vec3 gravity = Vec3::Zero();
  std::vector<Vec3> x, v;

  void step(double dt) {
    const double mass = 4 * std::sqrt(2.0) * soil.rho0_kg_m3 * std::pow(soil.radius_m, 3);
    std::vector<Vec3> force(x.size(), mass * gravity);
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (std::size_t j = i + 1; j < x.size(); ++j) {
        const double a = (x[i] - x[j]).norm();
        const Vec3 f = referenceContact(soil, (x[i] - x[j]) / a, a, v[i] - v[j], dt, slip_[{i, j}]).force_n;
        force[i] += f;
        force[j] -= f;
      }
      // The floor is the particle's mirror image: it comes as fast as the particle goes, and does not slide.
      const Vec3 against(v[i].x(), v[i].y(), 2 * v[i].z());
      force[i] += referenceContact(soil, Vec3::UnitZ(), 2 * x[i].z(), against, dt, slip_[{i, kFloor}]).force_n;
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      v[i] += dt / mass * force[i];
      x[i] += dt * v[i];
    }
  }

 private:
  static constexpr std::size_t kFloor = ~std::size_t{0};
  struct ZeroSlip : Vec3 {
    ZeroSlip() : Vec3(Vec3::Zero()) {}
  };
  std::map<std::pair<std::size_t, std::size_t>, ZeroSlip> slip_;
};

}  // namespace haptolith
