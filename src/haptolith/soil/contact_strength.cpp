#include "haptolith/soil/contact_strength.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "haptolith/core/find_root.h"
#include "haptolith/core/math/portable_math.h"

namespace haptolith {

namespace {

/// The contacts that the table is good for, somewhat beyond its ends.
constexpr double kLeastFriction = 0.1, kMostFriction = 0.85, kMostCohesion_n = 1.5;

/// Results of simulated shear tests of lunar contacts (lab/report/calibrate_soil.cpp; shearTest(), seed 1; where
/// friction and cohesion are both large, rounded guesses from the neighbours): the surrogate with which a calibration
/// begins. Only its slopes matter in the end.
constexpr std::array kFrictions{0.2, 0.35, 0.5, 0.7};
constexpr std::array kCohesions_n{0.0, 0.1, 0.3, 0.9};
using Table = std::array<std::array<ShearStrength, 4>, 4>;  // [cohesion][friction]
constexpr Table kResidual{{
    {{{26.3, -11}, {36.4, 0}, {43.2, 67}, {46.4, 225}}},
    {{{28.3, 383}, {39.1, 359}, {43.6, 421}, {47, 550}}},
    {{{36.8, 888}, {49.4, 577}, {52, 700}, {54, 900}}},
    {{{50.7, 2312}, {60.6, 2426}, {62.9, 3407}, {64, 4200}}},
}};
constexpr Table kPeak{{
    {{{28.5, -9}, {39.5, 39}, {47.6, 122}, {55.6, 385}}},
    {{{31.7, 464}, {41.7, 604}, {48.5, 774}, {56, 1000}}},
    {{{37.5, 1219}, {44.9, 1595}, {50, 2050}, {56, 2700}}},
    {{{40.1, 4120}, {46.3, 5450}, {49.2, 7084}, {54, 9000}}},
}};

template <std::size_t kKnots>
std::size_t cellOf(const std::array<double, kKnots>& knots, double x) {
  std::size_t cell = 0;
  while (cell + 2 < kKnots && x > knots[cell + 1]) {
    ++cell;
  }
  return cell;
}

/// Strength of a contact of another size at the same stress: as R^2.
double sizeFactor(const SoilParameters& soil) {
  return portable::square(soil.radius_m / kTabulatedRadius_m);
}

ContactStrength contactOf(const SoilParameters& soil) {
  return {soil.contact_friction, soil.contact_cohesion_n / sizeFactor(soil)};
}

}  // namespace

SoilParameters lunarContacts() {
  SoilParameters soil;
  soil.radius_m = kTabulatedRadius_m;
  soil.gamma_nm = 6e-5;
  soil.rho0_kg_m3 = 1430;
  soil.rho_max_kg_m3 = 1840;
  soil.stiffness_n_m = 3000;
  soil.friction = FrictionModel::kContact;
  soil.size_spread = 0.15;
  return soil;
}

ShearStrength tabulatedStrength(const ContactStrength& contact, SoilStrength kind) {
  const Table& table = kind == SoilStrength::kPeak ? kPeak : kResidual;
  const std::size_t i = cellOf(kCohesions_n, contact.cohesion_n);
  const std::size_t j = cellOf(kFrictions, contact.friction);
  const double u = (contact.cohesion_n - kCohesions_n[i]) / (kCohesions_n[i + 1] - kCohesions_n[i]);
  const double v = (contact.friction - kFrictions[j]) / (kFrictions[j + 1] - kFrictions[j]);
  const auto mix = [&](double ShearStrength::*what) {
    return (1 - u) * ((1 - v) * (table[i][j].*what) + v * (table[i][j + 1].*what)) +
           u * ((1 - v) * (table[i + 1][j].*what) + v * (table[i + 1][j + 1].*what));
  };
  return {mix(&ShearStrength::angle_deg), mix(&ShearStrength::cohesion_pa)};
}

ContactStrength tabulatedContact(const ShearStrength& wanted, SoilStrength kind) {
  const auto cohesion_for = [&](double friction) {
    return wanted.cohesion_pa <= 0 ? 0 : findRoot({0, kMostCohesion_n}, [&](double cohesion) {
      return tabulatedStrength({friction, cohesion}, kind).cohesion_pa - wanted.cohesion_pa;
    });
  };
  const double friction = findRoot({kLeastFriction, kMostFriction}, [&](double mu) {
    return tabulatedStrength({mu, cohesion_for(mu)}, kind).angle_deg - wanted.angle_deg;
  });
  return {friction, cohesion_for(friction)};
}

CalibratedStrength::CalibratedStrength(const SoilParameters& calibrated, const SoilTarget& target)
    : kind_(target.strength) {
  const ContactStrength contact = contactOf(calibrated);
  const double cohesion_pa = cohesionOf(contact);
  cohesion_factor_ = target.cohesion_pa > 0 && cohesion_pa > 0 ? target.cohesion_pa / cohesion_pa : 1;
  angle_offset_deg_ = target.friction_angle_deg - tabulatedStrength(contact, kind_).angle_deg;
}

/// A bed without cohesion between its particles has none, whatever a line through its shear stresses says.
double CalibratedStrength::cohesionOf(const ContactStrength& contact) const {
  const double without_pa = tabulatedStrength({contact.friction, 0}, kind_).cohesion_pa;
  return cohesion_factor_ * std::max(0.0, tabulatedStrength(contact, kind_).cohesion_pa - without_pa);
}

ShearStrength CalibratedStrength::at(const ContactStrength& contact) const {
  return {tabulatedStrength(contact, kind_).angle_deg + angle_offset_deg_, cohesionOf(contact)};
}

double CalibratedStrength::contactCohesionFor(double friction, double cohesion_pa) const {
  return cohesion_pa <= 0 ? 0 : findRoot({0, kMostCohesion_n}, [&](double cohesion_n) {
    return cohesionOf({friction, cohesion_n}) - cohesion_pa;
  });
}

ShearStrength CalibratedStrength::of(const SoilParameters& soil) const {
  return at(contactOf(soil));
}

SoilParameters CalibratedStrength::with(SoilParameters soil, const ShearStrength& wanted) const {
  soil.contact_friction = findRoot({kLeastFriction, kMostFriction}, [&](double friction) {
    return at({friction, contactCohesionFor(friction, wanted.cohesion_pa)}).angle_deg - wanted.angle_deg;
  });
  soil.contact_cohesion_n = contactCohesionFor(soil.contact_friction, wanted.cohesion_pa) * sizeFactor(soil);
  return soil;
}

Range CalibratedStrength::anglesFor(const SoilParameters& soil) const {
  const double cohesion_pa = of(soil).cohesion_pa;
  const auto angle_deg = [&](double friction) {
    return at({friction, contactCohesionFor(friction, cohesion_pa)}).angle_deg;
  };
  const double now_deg = of(soil).angle_deg;
  return {std::min(angle_deg(kLeastFriction), now_deg), std::max(angle_deg(kMostFriction), now_deg)};
}

Range CalibratedStrength::cohesionsFor(const SoilParameters& soil) const {
  return {0, std::max(cohesionOf({soil.contact_friction, kMostCohesion_n}), of(soil).cohesion_pa)};
}

}  // namespace haptolith
