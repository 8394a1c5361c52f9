#include "haptolith/soil/contact_law.h"

#include <algorithm>
#include <cmath>

#include "haptolith/core/error.h"
#include "haptolith/soil/contact_law-inl.h"

namespace haptolith {

ContactLaw makeContactLaw(const SoilParameters& soil) {
  validate(soil);
  const double diameter = 2 * soil.radius_m;
  const double compaction = soil.rho0_kg_m3 / soil.rho_max_kg_m3;

  ContactLaw law;
  law.gamma_nm = soil.gamma_nm;
  law.a_min_m = diameter / std::sqrt(3.0) * std::sqrt(2 * compaction * compaction + 1);
  law.h_n = soil.gamma_nm / (diameter - law.a_min_m);
  law.cutoff_m = diameter * soil.attraction_ratio;
  if (std::isinf(soil.stiffness_n_m)) {
    law.a_thr_m = law.a_min_m;
  } else {
    // Softer than the hyperbola at 2R, and the line would begin outside the particles.
    const double softest = soil.gamma_nm / std::pow(diameter - law.a_min_m, 2);
    requireInRange("stiffness_n_m", soil.stiffness_n_m, {softest, Range{}.highest, Ends::kOpenBelow});
    law.stiffness_n_m = soil.stiffness_n_m;
    law.a_thr_m = law.a_min_m + std::sqrt(soil.gamma_nm / soil.stiffness_n_m);
  }
  return law;
}

double contactForce(const ContactLaw& law, double a_m) noexcept {
  if (a_m >= law.cutoff_m) {
    return 0;
  }
  const HWY_NAMESPACE::LawOf<double> constants{law.gamma_nm, law.a_min_m, law.a_thr_m, law.h_n, law.stiffness_n_m};
  return HWY_NAMESPACE::uncutContactForce(constants, a_m);
}

double contactEnergy(const ContactLaw& law, double a_m) noexcept {
  if (a_m >= law.cutoff_m) {
    return 0;
  }
  const double held = std::max(a_m, law.a_thr_m);
  const double hyperbola =
      law.gamma_nm * std::log((law.cutoff_m - law.a_min_m) / (held - law.a_min_m)) - law.h_n * (law.cutoff_m - held);
  const double line = held - a_m;
  return hyperbola + contactForce(law, held) * line + law.stiffness_n_m / 2 * line * line;
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
  wall.cutoff_m = 2 * radius_m;
  return wall;
}

}  // namespace haptolith
