#pragma once

#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// Constants of the contact law (paper 7, 19), worked out once from the soil.
///
///     F(a) = gamma / (a - a_min) - h       for a_thr <= a < cutoff
///     F(a) = F(a_thr) + k (a_thr - a)      for a < a_thr
///     F(a) = 0                             for a >= cutoff
///
/// a is the distance between two centres in m. F > 0 repels; between 2R and the cutoff F < 0 attracts, and at the
/// cutoff it jumps to 0. a_thr is where the slope of the hyperbola is -k, so F is C1 there.
///
/// With contact friction repulsion is the same, and attraction is a separate parameter: beyond 2R
///
///     F(a) = -4 F_c s (1 - s),   s = (a - 2R) / range        for 2R <= a < cutoff = 2R + range
///
/// which has its maximum F_c halfway and fades to zero; without cohesion the cutoff is 2R.
struct ContactLaw {
  double gamma_nm = 0;
  double a_min_m = 0;         ///< (paper 8)
  double a_thr_m = 0;         ///< a_min + sqrt(gamma / k)
  double h_n = 0;             ///< gamma / (2R - a_min), makes F(2R) = 0
  double stiffness_n_m = 0;   ///< k; 0 when the soil's k is infinite: then a_thr = a_min and the line is never reached
  double cutoff_m = 0;        ///< 2 R_attr; with contact friction 2R + range
  double diameter_m = 0;      ///< 2R
  bool own_cohesion = false;  ///< contact: attraction is F_c's, not the hyperbola's
  double cohesion_n = 0;      ///< F_c
  double cohesion_range_m = 0;  ///< range, never 0
};

/// (paper 8): a_min = 2R/sqrt(3) sqrt(2 (rho0/rho_max)^2 + 1), and what follows from it.
/// @throws InvalidParameter as validate(SoilParameters); for a k below the hyperbola at 2R; for a gamma too small
/// for double precision (requireHyperbola()).
[[nodiscard]] ContactLaw makeContactLaw(const SoilParameters& soil);

/// Requires a hyperbola of (paper 7) with finite k that is at least `least` times a_min long: rounding of a_min divides
/// by it. @throws InvalidParameter with the gamma in N m that it takes.
void requireHyperbola(const ContactLaw& law, double least);

/// gamma in N m with which (paper 7) is a linear spring of stiffness k, whatever the distance: k (2R - a_min)^2. Soil
/// of such contacts is as dense at any depth, as far as its springs do not give; with less gamma it yields at first and
/// is denser below, as lunar soil is. @throws as makeContactLaw().
[[nodiscard]] double linearGamma(const SoilParameters& soil);

/// Returns the soil with another k; a linear spring remains one. @throws as makeContactLaw().
[[nodiscard]] SoilParameters withStiffness(SoilParameters soil, double stiffness_n_m);

/// F(a) in N at centre distance `a_m`, cutoff included (paper 19). The law itself is written in contact_law-inl.h.
[[nodiscard]] double contactForce(const ContactLaw& law, double a_m) noexcept;

/// Work needed to bring two particles from beyond the cutoff to `a_m`, in J: the integral of F from a to the cutoff.
/// Negative where attraction has pulled them together.
[[nodiscard]] double contactEnergy(const ContactLaw& law, double a_m) noexcept;

/// The centre distance in m at which two particles repel with `force_n` >= 0: F(a) solved for a.
[[nodiscard]] double distanceAtForce(const ContactLaw& law, double force_n) noexcept;

/// Force of a flat wall on a particle: it acts like the particle's mirror image, so F is taken at twice the
/// distance to the wall, and only repels; with contact friction a wall coheres like the soil. A layer on the floor is
/// then as stiff as a layer on a layer.
[[nodiscard]] ContactLaw wallLaw(const ContactLaw& law, double radius_m) noexcept;

}  // namespace haptolith
