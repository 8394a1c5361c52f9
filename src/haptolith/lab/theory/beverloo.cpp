#include "haptolith/lab/theory/beverloo.h"

#include <cmath>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/lab/theory/straight_line.h"

namespace haptolith {

namespace {

constexpr double kMostGap = 5;

/// Returns D - k d, the opening for the centres of the particles.
double freeOpening(double opening_m, double particle_diameter_m, double gap) {
  requireInRange("particle_diameter_m", particle_diameter_m, {0, Range{}.highest, Ends::kOpen});
  requireInRange("gap", gap, {0, kMostGap});
  const double closed = gap * particle_diameter_m;
  return requireInRange("opening_m", opening_m, {closed, Range{}.highest, Ends::kOpen}) - closed;
}

}  // namespace

double beverlooRate(const Outlet& outlet) {
  requireInRange("density_kg_m3", outlet.density_kg_m3, {0, Range{}.highest, Ends::kOpen});
  requireInRange("gravity_m_s2", outlet.gravity_m_s2, {0, 1000});
  requireInRange("coefficient", outlet.coefficient, {0, 2, Ends::kOpenBelow});
  return outlet.coefficient * outlet.density_kg_m3 * std::sqrt(outlet.gravity_m_s2) *
         std::pow(freeOpening(outlet.opening_m, outlet.particle_diameter_m, outlet.gap), 2.5);
}

double DischargeFit::rateAt(double opening_m, double particle_diameter_m) const {
  return prefactor * std::pow(freeOpening(opening_m, particle_diameter_m, gap), exponent);
}

DischargeFit fitDischarge(std::span<const DischargePoint> points, double particle_diameter_m, double gap) {
  std::vector<double> log_opening;
  std::vector<double> log_rate;
  for (const DischargePoint& point : points) {
    requireInRange("rate_kg_s", point.rate_kg_s, {0, Range{}.highest, Ends::kOpen});
    log_opening.push_back(std::log(freeOpening(point.opening_m, particle_diameter_m, gap)));
    log_rate.push_back(std::log(point.rate_kg_s));
  }
  const StraightLine line = fitStraightLine(log_opening, log_rate);
  return {.prefactor = std::exp(line.intercept),
          .exponent = line.slope,
          .exponent_se = line.slope_se,
          .gap = gap,
          .log_residual = line.residual_sd};
}

}  // namespace haptolith
