#include "haptolith/bed/kernel/kernel_law.h"

#include <algorithm>
#include <cmath>

namespace haptolith {

KernelLaw kernelLaw(const ContactLaw& law, double radius_m) {
  const auto f = [](double value) { return static_cast<float>(value); };
  return {f(law.gamma_nm),      f(law.a_min_m),  f(law.a_thr_m), f(law.h_n),
          f(law.stiffness_n_m), f(law.cutoff_m), f(2 * radius_m)};
}

SoilParameters soilBetween(const SoilParameters& soil, int class_a, int class_b) {
  const double a = GrainClasses::scale(class_a);
  const double b = GrainClasses::scale(class_b);
  return class_a == class_b ? rescaled(soil, a * soil.radius_m) : rescaled(soil, 2 * a * b / (a + b) * soil.radius_m);
}

double massBetween(const SoilParameters& soil, int class_a, int class_b) {
  const double a = GrainClasses::scale(3 * class_a);
  const double b = GrainClasses::scale(3 * class_b);
  return class_a == class_b ? a * macroparticleMass(soil) : 2 * a * b / (a + b) * macroparticleMass(soil);
}

ContactFrictionLaw contactFrictionLaw(const SoilParameters& coarsest, int class_a, int class_b) {
  const auto f = [](double value) { return static_cast<float>(value); };
  const SoilParameters soil = soilBetween(coarsest, class_a, class_b);
  const ContactLaw law = makeContactLaw(soil);
  const double tangential_stiffness = soil.tangential_ratio * soil.stiffness_n_m;
  const double damping = soil.damping_ratio * std::sqrt(2 * massBetween(coarsest, class_a, class_b));
  return {.normal = kernelLaw(law, soil.radius_m),
          .diameter_deficit = f(2 * (coarsest.radius_m - soil.radius_m)),
          .cohesion = f(law.cohesion_n),
          .two_per_range = f(2 / law.cohesion_range_m),
          .damping = f(damping * std::sqrt(law.gamma_nm)),
          .friction = f(soil.contact_friction),
          .stiffness = f(tangential_stiffness),
          .lag = f(damping / std::sqrt(tangential_stiffness))};
}

GradedLaw gradedLaw(const SoilParameters& soil, int classes) {
  GradedLaw law{GrainClasses(soil.radius_m, classes)};
  for (int a = 0; a < classes; ++a) {
    for (int b = 0; b < classes; ++b) {
      law.between[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] =
          contactFrictionLaw(soil, std::min(a, b), std::max(a, b));
    }
  }
  return law;
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
