#pragma once

#include <array>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/bed/grain_classes.h"
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
  float diameter_deficit;         ///< 2 (R_0 - R_pair), m: contact begins this much closer than for two of class 0
  float cohesion, two_per_range;  ///< F_c in N; 2 / range in 1/m
  float damping;    ///< zeta sqrt(2 m gamma): c is that times sqrt(-dF/da / gamma), zeta of a pair's critical
  float friction;   ///< mu_p
  float stiffness;  ///< k_t, N/m
  float lag;        ///< c_t / k_t, s, with c_t = zeta sqrt(2 m k_t)
};
/// Between grains of two classes, or of one: the law of grains of one size between, R = 2 R_a R_b / (R_a + R_b), damped
/// as two of the mass 2 m_a m_b / (m_a + m_b): springs one behind the other, and the reduced mass.
[[nodiscard]] ContactFrictionLaw contactFrictionLaw(const SoilParameters& coarsest, int class_a = 0, int class_b = 0);

/// Laws of every pair of classes, and the radii that separate classes.
struct GradedLaw {
  GrainClasses classes;
  std::array<std::array<ContactFrictionLaw, GrainClasses::kMost>, GrainClasses::kMost> between{};

  [[nodiscard]] const ContactFrictionLaw& coarsest() const noexcept { return between[0][0]; }
};
[[nodiscard]] GradedLaw gradedLaw(const SoilParameters& soil, int classes);

/// Mass of each of two equal grains that are as hard to part as grains of these classes are: 2 m_a m_b / (m_a + m_b).
[[nodiscard]] double massBetween(const SoilParameters& soil, int class_a, int class_b);

/// The soil of the grains that two of different classes touch like; of one class that class's own.
[[nodiscard]] SoilParameters soilBetween(const SoilParameters& soil, int class_a, int class_b);

/// Periods of the box, for beds that have periods instead of walls; 0 along an axis that has walls.
struct Periods {
  float width = 0, length = 0;          ///< m, along x and y
  float per_width = 0, per_length = 0;  ///< 1 / width and 1 / length, or 0

  [[nodiscard]] bool any() const noexcept { return width > 0 || length > 0; }
};
[[nodiscard]] Periods periodsOf(const BedParameters& bed);

}  // namespace haptolith
