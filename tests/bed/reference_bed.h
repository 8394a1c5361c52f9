#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "haptolith/bed/measure/reference_contact.h"

namespace haptolith {

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
