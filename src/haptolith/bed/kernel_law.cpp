#include "haptolith/bed/kernel_law.h"

#include <cmath>

namespace haptolith {

KernelLaw kernelLaw(const ContactLaw& law, double radius_m) {
  const auto f = [](double value) { return static_cast<float>(value); };
  return {f(law.gamma_nm),      f(law.a_min_m),  f(law.a_thr_m), f(law.h_n),
          f(law.stiffness_n_m), f(law.cutoff_m), f(2 * radius_m)};
}

ContactFrictionLaw contactFrictionLaw(const SoilParameters& soil) {
  const auto f = [](double value) { return static_cast<float>(value); };
  const ContactLaw law = makeContactLaw(soil);
  const double tangential_stiffness = soil.tangential_ratio * soil.stiffness_n_m;
  const double damping = soil.damping_ratio * std::sqrt(2 * macroparticleMass(soil));
  return {.normal = kernelLaw(law, soil.radius_m),
          .cohesion = f(law.cohesion_n),
          .two_per_range = f(2 / law.cohesion_range_m),
          .damping = f(damping * std::sqrt(law.gamma_nm)),
          .friction = f(soil.contact_friction),
          .stiffness = f(tangential_stiffness),
          .lag = f(damping / std::sqrt(tangential_stiffness))};
}

Periods periodsOf(const BedParameters& bed) {
  Periods periods;
  if (bed.periodic_x) {
    periods.width = static_cast<float>(bed.width_m);
    periods.per_width = 1 / periods.width;
  }
  if (bed.periodic_y) {
    periods.length = static_cast<float>(bed.length_m);
    periods.per_length = 1 / periods.length;
  }
  return periods;
}

}  // namespace haptolith
