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

namespace {

/// Terms of Vesic's equation with their factors of shape and depth, in Pa.
struct VesicTerms {
  double cohesion_pa, surcharge_pa, weight_pa;
};

VesicTerms vesicTerms(const Footing& footing, const BearingCapacity& factors) {
  const double phi = footing.friction_angle_rad;
  const double ratio = footing.depth_m / footing.diameter_m;
  const double k = ratio > 1 ? std::atan(ratio) : ratio;
  const double depth_q = 1 + 2 * std::tan(phi) * std::pow(1 - std::sin(phi), 2) * k;
  return {.cohesion_pa = footing.cohesion_pa * factors.n_c * (1 + factors.n_q / factors.n_c) * (1 + 0.4 * k),
          .surcharge_pa = beside(footing) * factors.n_q * (1 + std::tan(phi)) * depth_q,
          .weight_pa = 0.6 / 2 * ofWeight(footing) * factors.n_gamma};
}

BearingCapacity vesicFactors(double phi) {
  BearingCapacity factors;
  factors.n_q = std::exp(std::numbers::pi * std::tan(phi)) * passive(phi);
  factors.n_c = cohesionFactor(factors.n_q, phi, kCohesionAlone);
  factors.n_gamma = 2 * (factors.n_q + 1) * std::tan(phi);
  return factors;
}

}  // namespace

BearingCapacity vesicBearing(const Footing& footing) {
  validate(footing);
  BearingCapacity result = vesicFactors(footing.friction_angle_rad);
  const VesicTerms terms = vesicTerms(footing, result);
  result.pressure_pa = terms.cohesion_pa + terms.surcharge_pa + terms.weight_pa;
  return result;
}

CompressibleBearing vesicCompressibleBearing(const Footing& footing, const Compressibility& soil) {
  validate(footing);
  requireInRange("shear_modulus_pa", soil.shear_modulus_pa, {0, Range{}.highest, Ends::kOpen});
  requireInRange("volume_strain", soil.volume_strain, {0, 1});
  const double phi = footing.friction_angle_rad;
  const double overburden_pa = beside(footing) + ofWeight(footing) / 2;
  const double rigidity = soil.shear_modulus_pa / (footing.cohesion_pa + overburden_pa * std::tan(phi));
  CompressibleBearing result;
  result.rigidity_index = rigidity / (1 + rigidity * soil.volume_strain);
  result.critical_rigidity_index = std::exp(2.85 / std::tan(std::numbers::pi / 4 - phi / 2)) / 2;
  const BearingCapacity factors = vesicFactors(phi);
  double of_cohesion = 1;
  if (result.rigidity_index < result.critical_rigidity_index) {
    const double sine = std::sin(phi);
    const double index = result.rigidity_index;
    result.compressibility_factor =
        std::min(1.0, std::exp(-3.8 * std::tan(phi) + 3.07 * sine * std::log10(2 * index) / (1 + sine)));
    const double zeta = result.compressibility_factor;
    of_cohesion = phi < kFrictionless ? std::clamp(0.44 + 0.6 * std::log10(index), 0.0, 1.0)
                                      : std::max(0.0, zeta - (1 - zeta) / (factors.n_q - 1));
  }
  const VesicTerms terms = vesicTerms(footing, factors);
  result.pressure_pa =
      of_cohesion * terms.cohesion_pa + result.compressibility_factor * (terms.surcharge_pa + terms.weight_pa);
  return result;
}

}  // namespace haptolith
