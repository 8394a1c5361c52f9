#include "haptolith/soil/contact_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "haptolith/core/error.h"
#include "haptolith/core/math/portable_math.h"
#include "haptolith/soil/contact_law-inl.h"

namespace haptolith {

namespace {

/// a_min of (paper 8), in m.
double leastDistance(const SoilParameters& soil) {
  const double compaction = soil.rho0_kg_m3 / soil.rho_max_kg_m3;
  return 2 * soil.radius_m / std::sqrt(3.0) * std::sqrt(2 * compaction * compaction + 1);
}

}  // namespace

ContactLaw makeContactLaw(const SoilParameters& soil) {
  validate(soil);
  const double diameter = 2 * soil.radius_m;

  ContactLaw law;
  law.gamma_nm = soil.gamma_nm;
  law.a_min_m = leastDistance(soil);
  law.h_n = soil.gamma_nm / (diameter - law.a_min_m);
  law.diameter_m = diameter;
  law.cutoff_m = diameter * soil.attraction_ratio;
  if (soil.friction == FrictionModel::kContact) {
    law.own_cohesion = true;
    law.cohesion_n = soil.contact_cohesion_n;
    law.cohesion_range_m = soil.cohesion_range_ratio * soil.radius_m;
    law.cutoff_m = diameter + (law.cohesion_n > 0 ? law.cohesion_range_m : 0);
  }
  if (std::isinf(soil.stiffness_n_m)) {
    law.a_thr_m = law.a_min_m;
  } else {
    // Softer than the hyperbola at 2R, and the line would begin outside the particles. Just as stiff (to rounding) is a
    // linear spring.
    constexpr double kRounding = 1e-9;
    const double softest = soil.gamma_nm / portable::square(diameter - law.a_min_m) * (1 - kRounding);
    if (!(soil.stiffness_n_m >= softest)) {
      throw InvalidParameter("stiffness_n_m", fmt::format("{:g}", soil.stiffness_n_m),
                             fmt::format(">= {:.5g} for macroparticles of {:g} mm (gamma_nm = {:g}); give it with "
                                         "radius_mm, or a radius_mm as small as it is meant for",
                                         (1 + 1e-5) * softest, 1e3 * soil.radius_m, soil.gamma_nm));
    }
    law.stiffness_n_m = soil.stiffness_n_m;
    law.a_thr_m = std::min(law.a_min_m + std::sqrt(soil.gamma_nm / soil.stiffness_n_m), diameter);
    requireHyperbola(law, 1e-9);
  }
  return law;
}

void requireHyperbola(const ContactLaw& law, double least) {
  if (law.a_thr_m - law.a_min_m < least * law.a_min_m) {
    throw InvalidParameter(
        "gamma_nm", fmt::format("{:g}", law.gamma_nm),
        fmt::format(">= {:.5g} for stiffness_n_m = {:g}",
                    law.stiffness_n_m * portable::square(least * law.a_min_m) * (1 + 1e-3), law.stiffness_n_m));
  }
}

double linearGamma(const SoilParameters& soil) {
  validate(soil);
  const double give_m = 2 * soil.radius_m - leastDistance(soil);
  return soil.stiffness_n_m * give_m * give_m;
}

SoilParameters withStiffness(SoilParameters soil, double stiffness_n_m) {
  constexpr double kRounding = 1e-6;  // relative rounding of a number in a file
  const bool linear = std::abs(soil.gamma_nm / linearGamma(soil) - 1) < kRounding;
  soil.stiffness_n_m = stiffness_n_m;
  if (linear) {
    soil.gamma_nm = linearGamma(soil);
  }
  return soil;
}

namespace {

HWY_NAMESPACE::LawOf<double> repulsionOf(const ContactLaw& law) noexcept {
  return {law.gamma_nm, law.a_min_m, law.a_thr_m, law.h_n, law.stiffness_n_m};
}

HWY_NAMESPACE::CohesionOf<double> cohesionOf(const ContactLaw& law) noexcept {
  return {law.cohesion_n, 2 / law.cohesion_range_m, 0, 1};
}

/// Integral of (paper 7) from `a_m` to `end_m`.
double hyperbolaEnergy(const ContactLaw& law, double a_m, double end_m) noexcept {
  const double held = std::max(a_m, law.a_thr_m);
  const double hyperbola =
      law.gamma_nm * portable::log((end_m - law.a_min_m) / (held - law.a_min_m)) - law.h_n * (end_m - held);
  const double line = held - a_m;
  return hyperbola + HWY_NAMESPACE::uncutContactForce(repulsionOf(law), held) * line +
         law.stiffness_n_m / 2 * line * line;
}

/// Integral of the pull of F_c from `a_m` >= 2R to the cutoff: -4 F_c range (1/6 - s^2/2 + s^3/3).
double cohesionEnergy(const ContactLaw& law, double a_m) noexcept {
  const double s = (a_m - law.diameter_m) / law.cohesion_range_m;
  return -4 * law.cohesion_n * law.cohesion_range_m * (1.0 / 6 - s * s / 2 + s * s * s / 3);
}

}  // namespace

double contactForce(const ContactLaw& law, double a_m) noexcept {
  if (a_m >= law.cutoff_m) {
    return 0;
  }
  return law.own_cohesion
             ? HWY_NAMESPACE::cohesiveContact(repulsionOf(law), cohesionOf(law), law.diameter_m, a_m).normal
             : HWY_NAMESPACE::uncutContactForce(repulsionOf(law), a_m);
}

double contactEnergy(const ContactLaw& law, double a_m) noexcept {
  if (a_m >= law.cutoff_m) {
    return 0;
  }
  if (!law.own_cohesion) {
    return hyperbolaEnergy(law, a_m, law.cutoff_m);
  }
  return a_m < law.diameter_m ? hyperbolaEnergy(law, a_m, law.diameter_m) + cohesionEnergy(law, law.diameter_m)
                              : cohesionEnergy(law, a_m);
}

double distanceAtForce(const ContactLaw& law, double force_n) noexcept {
  const double on_hyperbola = law.a_min_m + law.gamma_nm / (force_n + law.h_n);
  if (on_hyperbola >= law.a_thr_m) {
    return on_hyperbola;
  }
  return law.a_thr_m - (force_n - contactForce(law, law.a_thr_m)) / law.stiffness_n_m;
}

ContactLaw wallLaw(const ContactLaw& law, double radius_m) noexcept {
  ContactLaw wall = law;
  if (!law.own_cohesion) {
    wall.cutoff_m = 2 * radius_m;
  }
  return wall;
}

}  // namespace haptolith
