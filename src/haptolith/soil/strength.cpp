#include "haptolith/soil/strength.h"

#include <cmath>
#include <limits>

#include "haptolith/core/error.h"
#include "haptolith/core/math/portable_math.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

namespace {

const double kSqrtSix = std::sqrt(6.0);

SoilParameters withInfiniteStiffness(SoilParameters soil) {
  soil.stiffness_n_m = std::numeric_limits<double>::infinity();
  return soil;
}

/// rho0 for which a_1 is the least a_min there is, 2R/sqrt(3).
const double kLeastRho0 = kCompactedDensity / portable::pow(3, 1.5);

}  // namespace

double leastCompactableRhoMax(double rho0_kg_m3, double overlap) {
  requireInRange("rho0_kg_m3", rho0_kg_m3, {kLeastRho0, kCompactedDensity, Ends::kOpen});
  requireInRange("overlap", overlap, {0, 1, Ends::kOpenBelow});
  const double a_1 = portable::cbrt(rho0_kg_m3 / kCompactedDensity);  // in units of 2R
  const double a_min = 1 - (1 - a_1) / overlap;
  const double compaction_squared = (3 * a_min * a_min - 1) / 2;  // (paper 8) solved for (rho0 / rho_max)^2
  const bool any_law = a_min > 0 && compaction_squared > 0;
  return any_law ? rho0_kg_m3 / std::sqrt(compaction_squared) : std::numeric_limits<double>::infinity();
}

double frictionCoefficient(double mu_hat) {
  return kSqrtSix * requireInRange("mu_hat", mu_hat, {0, 10});
}

double modelFriction(double friction_coefficient) {
  return requireInRange("friction_coefficient", friction_coefficient, {0, 24}) / kSqrtSix;
}

double frictionAngle(double friction_coefficient) {
  return portable::atan(requireInRange("friction_coefficient", friction_coefficient, {0, Range{}.highest}));
}

double compactedDistance(const SoilParameters& soil) {
  validate(soil);
  requireInRange("rho_max_kg_m3", soil.rho_max_kg_m3,
                 {leastCompactableRhoMax(soil.rho0_kg_m3, 1), Range{}.highest, Ends::kOpenBelow});
  return 2 * soil.radius_m * portable::cbrt(soil.rho0_kg_m3 / kCompactedDensity);
}

double cohesion(const SoilParameters& soil) {
  const double a_1 = compactedDistance(soil);
  const ContactLaw law = makeContactLaw(withInfiniteStiffness(soil));
  return 6 * std::sqrt(3.0) * soil.mu_hat * contactForce(law, a_1) / (a_1 * a_1);
}

}  // namespace haptolith
