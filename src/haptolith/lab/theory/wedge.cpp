#include "haptolith/lab/theory/wedge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/lab/theory/minimum.h"

namespace haptolith {

namespace {

/// Returns w (rho g d^2 N_gamma + ...) from the plane wedge's factors, with crescents equivalent to `sides_m` more
/// width.
double forceWithSides(const BladeCase& blade, const BladeForce& plane, double sides_m) {
  const double weight = blade.density_kg_m3 * blade.gravity_m_s2 * blade.depth_m * plane.n_gamma;
  const double ahead = blade.cohesion_pa * plane.n_c + blade.surcharge_pa * plane.n_q;
  const double beside =
      blade.cohesion_pa * plane.n_c + blade.surcharge_beside_pa.value_or(blade.surcharge_pa) * plane.n_q;
  const double adhesion = blade.adhesion_pa * plane.n_a;
  // A slice of a crescent tapers to a point below: it weighs two thirds of a wedge under the same surface area.
  return blade.depth_m *
         (weight * (blade.width_m + 2.0 / 3 * sides_m) + (ahead + adhesion) * blade.width_m + beside * sides_m);
}

WedgeForce forceAt(const BladeCase& blade, double beta) {
  const BladeForce plane = earthmovingForceAt(blade, beta);
  const double cot_rake = 1 / std::tan(blade.rake_rad);
  const double reach = cot_rake + 1 / std::tan(beta);  // r / d

  WedgeForce result;
  result.beta_rad = beta;
  result.rupture_distance_m = blade.depth_m * reach;
  result.crescent_angle_rad = std::acos(std::clamp(cot_rake / reach, 0.0, 1.0));
  result.crescent_width_m = result.rupture_distance_m * std::sin(result.crescent_angle_rad);
  const double widths = result.crescent_width_m / blade.width_m;
  result.n_gamma = plane.n_gamma * (1 + 2.0 / 3 * widths);
  result.n_c = plane.n_c * (1 + widths);
  result.n_a = plane.n_a;
  result.n_q = plane.n_q * (1 + widths);

  const double pushed = blade.rake_rad + blade.tool_friction_rad;
  const double adhesion = blade.adhesion_pa * blade.depth_m * blade.width_m;
  const double arc = result.rupture_distance_m * result.crescent_angle_rad;
  result.draft_n = forceWithSides(blade, plane, result.crescent_width_m) * std::sin(pushed) + adhesion * cot_rake;
  result.vertical_n = forceWithSides(blade, plane, arc) * std::cos(pushed) - adhesion;
  return result;
}

/// Returns the first local minimum of the draft over beta, from 0. At 90 deg the crescents vanish, and the wedge would
/// slide freely between two upright sides without strength. For a flat and narrow blade the draft is lower there, which
/// is an artefact.
double weakestSurface(const BladeCase& blade) {
  constexpr int kCells = 400;
  const double steepest = std::min(steepestFailurePlane(blade), std::numbers::pi / 2);
  const auto draft = [&](double beta) { return forceAt(blade, beta).draft_n; };
  const auto angle = [&](int cell) { return steepest * cell / kCells; };
  for (int cell = 2; cell < kCells; ++cell) {
    if (draft(angle(cell)) > draft(angle(cell - 1))) {
      return minimumBetween(angle(cell - 2), angle(cell), draft);
    }
  }
  throw InvalidParameter("rake_rad", fmt::format("{:.4g}", blade.rake_rad),
                         "steeper for a narrow blade: next to a flat blade no soil breaks out");
}

BladeForce uprightAt(const BladeCase& blade, double beta) {
  BladeForce result = earthmovingForceAt(blade, beta);
  const double pushed = blade.rake_rad + blade.tool_friction_rad;
  const double reach = 1 / std::tan(blade.rake_rad) + 1 / std::tan(beta);  // r / d
  const double friction = (1 - std::sin(blade.friction_angle_rad)) * std::tan(blade.friction_angle_rad);
  // Force from a stress of 1 on both sides, over the width: A is half of d^2 r / d.
  const double sides = reach * blade.depth_m / blade.width_m * std::cos(blade.friction_angle_rad) /
                       std::sin(pushed + beta + blade.friction_angle_rad);
  result.n_gamma += sides * friction / 3;
  result.n_c += sides;
  result.n_q += sides * friction;
  const double more = blade.width_m * blade.depth_m * sides *
                      (blade.cohesion_pa +
                       friction * (blade.density_kg_m3 * blade.gravity_m_s2 * blade.depth_m / 3 + blade.surcharge_pa));
  result.force_n += more;
  result.draft_n += more * std::sin(pushed);
  result.vertical_n += more * std::cos(pushed);
  return result;
}

}  // namespace

WedgeForce wedgeForce(const BladeCase& blade) {
  validate(blade);
  requireInRange("rake_rad", blade.rake_rad, {0, std::numbers::pi / 2, Ends::kOpenBelow});
  return forceAt(blade, weakestSurface(blade));
}

BladeForce uprightWedgeForce(const BladeCase& blade) {
  validate(blade);
  const double beta =
      minimumBetween(0, steepestFailurePlane(blade), [&](double angle) { return uprightAt(blade, angle).force_n; });
  return uprightAt(blade, beta);
}

}  // namespace haptolith
