#include "haptolith/lab/theory/earthmoving.h"

#include <cmath>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/lab/theory/minimum.h"

namespace haptolith {

namespace {

constexpr double kMostFriction = std::numbers::pi / 3;  // rad; above that of any soil
constexpr double kMostAngles =
    std::numbers::pi * 175 / 180;  // rad; alpha + delta + phi; at 180 deg the range of beta is empty

double cot(double angle_rad) {
  return 1 / std::tan(angle_rad);
}

}  // namespace

void validate(const BladeCase& blade) {
  const Range positive{0, Range{}.highest, Ends::kOpen};
  const Range not_negative{0, Range{}.highest};
  requireInRange("width_m", blade.width_m, positive);
  requireInRange("depth_m", blade.depth_m, positive);
  requireInRange("density_kg_m3", blade.density_kg_m3, positive);
  requireInRange("gravity_m_s2", blade.gravity_m_s2, {0, 1000, Ends::kOpenBelow});
  requireInRange("friction_angle_rad", blade.friction_angle_rad, {0, kMostFriction});
  requireInRange("tool_friction_rad", blade.tool_friction_rad, {0, kMostFriction});
  requireInRange("cohesion_pa", blade.cohesion_pa, not_negative);
  requireInRange("adhesion_pa", blade.adhesion_pa, {0, blade.cohesion_pa});
  requireInRange("surcharge_pa", blade.surcharge_pa, not_negative);
  requireInRange("surcharge_beside_pa", blade.surcharge_beside_pa.value_or(0), not_negative);
  requireInRange("rake_rad", blade.rake_rad,
                 {0, kMostAngles - blade.tool_friction_rad - blade.friction_angle_rad, Ends::kOpen});
}

double steepestFailurePlane(const BladeCase& blade) {
  return std::numbers::pi - blade.rake_rad - blade.tool_friction_rad - blade.friction_angle_rad;
}

BladeForce earthmovingForceAt(const BladeCase& blade, double beta_rad) {
  const double pushed = blade.rake_rad + blade.tool_friction_rad;
  const double cot_plane = cot(beta_rad + blade.friction_angle_rad);
  const double d = std::cos(pushed) + std::sin(pushed) * cot_plane;
  const double base = cot(blade.rake_rad) + cot(beta_rad);  // length of the wedge's surface over its depth

  BladeForce result;
  result.beta_rad = beta_rad;
  result.n_gamma = base / (2 * d);
  result.n_c = (1 + cot(beta_rad) * cot_plane) / d;
  result.n_a = (1 - cot(blade.rake_rad) * cot_plane) / d;
  result.n_q = base / d;
  const double per_width_and_depth = blade.density_kg_m3 * blade.gravity_m_s2 * blade.depth_m * result.n_gamma +
                                     blade.cohesion_pa * result.n_c + blade.adhesion_pa * result.n_a +
                                     blade.surcharge_pa * result.n_q;
  result.force_n = blade.width_m * blade.depth_m * per_width_and_depth;

  const double adhesion = blade.adhesion_pa * blade.depth_m * blade.width_m;
  result.draft_n = result.force_n * std::sin(pushed) + adhesion * cot(blade.rake_rad);
  result.vertical_n = result.force_n * std::cos(pushed) - adhesion;
  return result;
}

BladeForce earthmovingForce(const BladeCase& blade) {
  validate(blade);
  // N_gamma and N_c are infinite at both ends of the range.
  const double beta = minimumBetween(0, steepestFailurePlane(blade),
                                     [&](double angle) { return earthmovingForceAt(blade, angle).force_n; });
  return earthmovingForceAt(blade, beta);
}

}  // namespace haptolith
