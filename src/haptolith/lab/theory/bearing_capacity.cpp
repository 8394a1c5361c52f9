#include "haptolith/lab/theory/bearing_capacity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

constexpr double kFrictionless = 1e-9;  // rad; below it N_c is its limit
constexpr double kMeyerhofFrom =
    std::numbers::pi / 18;  // rad; from 10 deg the weight term has factors of shape and depth
constexpr double kCohesionAlone = std::numbers::pi + 2;  // Prandtl's N_c without friction
constexpr double kTerzaghiAlone = 1.5 * std::numbers::pi + 1;

void validate(const Footing& footing) {
  constexpr double kDeepest = 2.5;  // in diameters
  const Range positive{0, Range{}.highest, Ends::kOpen};
  requireInRange("diameter_m", footing.diameter_m, positive);
  requireInRange("depth_m", footing.depth_m, {0, kDeepest * footing.diameter_m});
  requireInRange("density_kg_m3", footing.density_kg_m3, positive);
  requireInRange("gravity_m_s2", footing.gravity_m_s2, {0, 1000, Ends::kOpenBelow});
  requireInRange("friction_angle_rad", footing.friction_angle_rad, {0, std::numbers::pi * 50 / 180});
  requireInRange("cohesion_pa", footing.cohesion_pa, {0, Range{}.highest});
}

/// Returns K_p = tan^2(45 deg + phi / 2), the coefficient of passive earth pressure.
double passive(double phi) {
  return std::pow(std::tan(std::numbers::pi / 4 + phi / 2), 2);
}

double cohesionFactor(double n_q, double phi, double frictionless) {
  return phi < kFrictionless ? frictionless : (n_q - 1) / std::tan(phi);
}

/// Returns Terzaghi's passive coefficient of weight, published as a curve; tabulated by Bowles (Foundation Analysis and
/// Design, 5th ed., 1996, table 4-2). Its logarithm is interpolated linearly.
double weightCoefficient(double phi) {
  struct Row {
    double deg, k;
  };
  static constexpr std::array<Row, 11> kTable{{{0, 10.8},
                                               {5, 12.2},
                                               {10, 14.7},
                                               {15, 18.6},
                                               {20, 25},
                                               {25, 35},
                                               {30, 52},
                                               {35, 82},
                                               {40, 141},
                                               {45, 298},
                                               {50, 800}}};
  const double deg = std::min(180 / std::numbers::pi * phi, kTable.back().deg);
  const auto* const above =
      std::ranges::find_if(kTable.begin() + 1, kTable.end(), [deg](const Row& row) { return row.deg >= deg; });
  const Row& low = *std::prev(above);
  return std::exp(std::lerp(std::log(low.k), std::log(above->k), (deg - low.deg) / (above->deg - low.deg)));
}

double beside(const Footing& footing) {
  return footing.density_kg_m3 * footing.gravity_m_s2 * footing.depth_m;
}
double ofWeight(const Footing& footing) {
  return footing.density_kg_m3 * footing.gravity_m_s2 * footing.diameter_m;
}

}  // namespace

BearingCapacity terzaghiBearing(const Footing& footing) {
  validate(footing);
  const double phi = footing.friction_angle_rad;
  BearingCapacity result;
  result.n_q = std::exp((1.5 * std::numbers::pi - phi) * std::tan(phi)) /
               (2 * std::pow(std::cos(std::numbers::pi / 4 + phi / 2), 2));
  result.n_c = cohesionFactor(result.n_q, phi, kTerzaghiAlone);
  result.n_gamma = std::tan(phi) / 2 * (weightCoefficient(phi) / std::pow(std::cos(phi), 2) - 1);
  result.pressure_pa =
      1.3 * footing.cohesion_pa * result.n_c + beside(footing) * result.n_q + 0.3 * ofWeight(footing) * result.n_gamma;
  return result;
}

BearingCapacity terzaghiLocalBearing(const Footing& footing) {
  validate(footing);
  constexpr double kShare = 2.0 / 3;
  Footing loose = footing;
  loose.cohesion_pa *= kShare;
  loose.friction_angle_rad = std::atan(kShare * std::tan(footing.friction_angle_rad));
  return terzaghiBearing(loose);
}

BearingCapacity meyerhofBearing(const Footing& footing) {
  validate(footing);
  const double phi = footing.friction_angle_rad;
  const double kp = passive(phi);
  const double depth = std::sqrt(kp) * footing.depth_m / footing.diameter_m;
  const double both = phi < kMeyerhofFrom ? 1 : (1 + 0.1 * kp) * (1 + 0.1 * depth);
  BearingCapacity result;
  result.n_q = std::exp(std::numbers::pi * std::tan(phi)) * kp;
  result.n_c = cohesionFactor(result.n_q, phi, kCohesionAlone);
  result.n_gamma = (result.n_q - 1) * std::tan(1.4 * phi);
  result.pressure_pa = footing.cohesion_pa * result.n_c * (1 + 0.2 * kp) * (1 + 0.2 * depth) +
                       (beside(footing) * result.n_q + ofWeight(footing) / 2 * result.n_gamma) * both;
  return result;
}

BearingCapacity vesicBearing(const Footing& footing) {
  validate(footing);
  const double phi = footing.friction_angle_rad;
  const double ratio = footing.depth_m / footing.diameter_m;
  const double k = ratio > 1 ? std::atan(ratio) : ratio;
  BearingCapacity result;
  result.n_q = std::exp(std::numbers::pi * std::tan(phi)) * passive(phi);
  result.n_c = cohesionFactor(result.n_q, phi, kCohesionAlone);
  result.n_gamma = 2 * (result.n_q + 1) * std::tan(phi);
  const double depth_q = 1 + 2 * std::tan(phi) * std::pow(1 - std::sin(phi), 2) * k;
  result.pressure_pa = footing.cohesion_pa * result.n_c * (1 + result.n_q / result.n_c) * (1 + 0.4 * k) +
                       beside(footing) * result.n_q * (1 + std::tan(phi)) * depth_q +
                       0.6 / 2 * ofWeight(footing) * result.n_gamma;
  return result;
}

}  // namespace haptolith
