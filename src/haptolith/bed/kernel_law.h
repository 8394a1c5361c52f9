#pragma once

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/soil/contact_law.h"
#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// The contact law's constants in the particles' precision.
struct KernelLaw {
  float gamma, a_min, a_thr, h, k, cutoff, diameter;
};
[[nodiscard]] KernelLaw kernelLaw(const ContactLaw& law, double radius_m);

/// Constants of contacts with contact friction, as the kernel and its walls want them.
struct ContactFrictionLaw {
  KernelLaw normal;
  float cohesion, two_per_range;  ///< F_c in N; 2 / range in 1/m
  float damping;    ///< zeta sqrt(2 m gamma): c is that times sqrt(-dF/da / gamma), zeta of a pair's critical
  float friction;   ///< mu_p
  float stiffness;  ///< k_t, N/m
  float lag;        ///< c_t / k_t, s, with c_t = zeta sqrt(2 m k_t)
};
[[nodiscard]] ContactFrictionLaw contactFrictionLaw(const SoilParameters& soil);

/// How often the box repeats itself, for beds that have periods instead of walls; 0 along an axis that has walls.
struct Periods {
  float width = 0, length = 0;          ///< m, along x and y
  float per_width = 0, per_length = 0;  ///< 1 / width and 1 / length, or 0

  [[nodiscard]] bool any() const noexcept { return width > 0 || length > 0; }
};
[[nodiscard]] Periods periodsOf(const BedParameters& bed);

}  // namespace haptolith
