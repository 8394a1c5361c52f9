#include "haptolith/lab/calibrate_soil.h"

#include <Eigen/Dense>
#include <boost/math/tools/toms748_solve.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/lab/settle.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

namespace {

constexpr double kTableRadius_m = 7e-3;
constexpr double kTableDensity_kg_m3 = 1500;  ///< of lunarContacts() in the upper 15 cm, on the Moon

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

/// Contacts of lunar soil: gamma and rho_max / rho0 give the measured density with depth, k carries 3 kPa with an
/// overlap that still leaves the particles round, and the sizes differ enough that they never crystallise.
SoilParameters lunarContacts() {
  SoilParameters soil;
  soil.radius_m = kTableRadius_m;
  soil.gamma_nm = 6e-5;
  soil.rho0_kg_m3 = 1430;
  soil.rho_max_kg_m3 = 1840;
  soil.stiffness_n_m = 3000;
  soil.friction = FrictionModel::kPairwise;
  soil.size_spread = 0.15;
  return soil;
}

/// A strength as a shear test gives it.
struct Strength {
  double angle_deg = 0;
  double cohesion_pa = 0;
};

/// Contact friction and cohesion, the latter for R = 7 mm.
struct Contact {
  double friction = 0;
  double cohesion_n = 0;
};

/// What shear tests of lunarContacts() showed (shearTest(), seed 1; where friction and cohesion are both large, rounded
/// guesses from the neighbours): the surrogate with which the search begins. Only its slopes matter in the end.
constexpr std::array kFrictions{0.2, 0.35, 0.5, 0.7};
constexpr std::array kCohesions_n{0.0, 0.1, 0.3, 0.9};
using Table = std::array<std::array<Strength, 4>, 4>;  // [cohesion][friction]
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

/// The table in between its knots, straight on beyond them.
Strength surrogate(const Table& table, const Contact& contact) {
  const std::size_t i = cellOf(kCohesions_n, contact.cohesion_n);
  const std::size_t j = cellOf(kFrictions, contact.friction);
  const double u = (contact.cohesion_n - kCohesions_n[i]) / (kCohesions_n[i + 1] - kCohesions_n[i]);
  const double v = (contact.friction - kFrictions[j]) / (kFrictions[j + 1] - kFrictions[j]);
  const auto mix = [&](double Strength::*what) {
    return (1 - u) * ((1 - v) * (table[i][j].*what) + v * (table[i][j + 1].*what)) +
           u * ((1 - v) * (table[i + 1][j].*what) + v * (table[i + 1][j + 1].*what));
  };
  return {mix(&Strength::angle_deg), mix(&Strength::cohesion_pa)};
}

/// Where an increasing function crosses zero between two ends; the nearer end when it does not.
template <class Function>
double crossing(double lowest, double highest, Function f) {
  const double at_lowest = f(lowest);
  const double at_highest = f(highest);
  if (at_lowest >= 0 || at_highest <= 0) {
    return at_lowest >= 0 ? lowest : highest;
  }
  std::uintmax_t iterations = 100;
  const auto bracket = boost::math::tools::toms748_solve(f, lowest, highest, at_lowest, at_highest,
                                                         boost::math::tools::eps_tolerance<double>(30), iterations);
  return (bracket.first + bracket.second) / 2;
}

/// The contact for which the surrogate has the wanted strength, as near as contacts go.
Contact contactFor(const Table& table, const Strength& wanted) {
  constexpr double kLeastFriction = 0.1, kMostFriction = 0.85, kMostCohesion_n = 1.5;
  const auto cohesion_for = [&](double friction) {
    return wanted.cohesion_pa <= 0 ? 0 : crossing(0, kMostCohesion_n, [&](double cohesion) {
      return surrogate(table, {friction, cohesion}).cohesion_pa - wanted.cohesion_pa;
    });
  };
  const double friction = crossing(kLeastFriction, kMostFriction, [&](double mu) {
    return surrogate(table, {mu, cohesion_for(mu)}).angle_deg - wanted.angle_deg;
  });
  return {friction, cohesion_for(friction)};
}

/// How a strength differs from another one, each part over what counts as the same.
Eigen::Vector2d distance(const Strength& from, const Strength& to) {
  constexpr double kAngle_deg = 0.5;
  const double cohesion_pa = std::max(0.06 * to.cohesion_pa, 20.0);
  return {(from.angle_deg - to.angle_deg) / kAngle_deg, (from.cohesion_pa - to.cohesion_pa) / cohesion_pa};
}

/// Broyden's method (1965) for the contact with the wanted strength: slopes come from the table at first, and then from
/// what each shear test taught. Friction goes as it is, cohesion over that of the table's third row.
class ContactSearch {
 public:
  ContactSearch(const Table& table, const Strength& wanted)
      : wanted_(wanted), cohesive_(wanted.cohesion_pa > 0), at_(toPoint(contactFor(table, wanted))) {
    constexpr double kStep = 0.02;
    const auto tabulated = [&](const Eigen::Vector2d& point) {
      return distance(surrogate(table, toContact(point)), wanted);
    };
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
      slopes_.col(axis) = (tabulated(at_ + step) - tabulated(at_ - step)) / (2 * kStep);
    }
    if (!cohesive_) {  // nothing can lower the cohesion of none
      slopes_.row(1) = slopes_.col(1).transpose() = Eigen::RowVector2d(0, 1);
    }
  }

  [[nodiscard]] Contact contact() const { return toContact(at_); }

  /// What the present contact showed; the next one is better. True when it is good enough.
  bool learn(const Strength& found) {
    Eigen::Vector2d error = distance(found, wanted_);
    error.y() = cohesive_ ? error.y() : 0;
    if (error.norm() < best_error_) {
      best_error_ = error.norm();
      best_ = at_;
      best_found_ = found;
    }
    if (error.cwiseAbs().maxCoeff() <= 1) {
      return true;
    }
    const Eigen::Vector2d moved = at_ - before_;
    constexpr double kScatter = 0.01;  // a shorter step says more about the specimens than about the slope
    if (steps_++ > 0 && moved.norm() > kScatter) {
      slopes_ += (error - error_before_ - slopes_ * moved) * moved.transpose() / moved.squaredNorm();
    }
    before_ = at_;
    error_before_ = error;
    constexpr double kLongest = 0.25;
    Eigen::Vector2d step = -slopes_.fullPivLu().solve(error);
    step *= std::min(1.0, kLongest / step.norm());
    at_ = (at_ + step).cwiseMax(Eigen::Vector2d(0.02, 0)).cwiseMin(Eigen::Vector2d(1.5, 5));
    return false;
  }

  [[nodiscard]] Contact best() const { return toContact(best_); }
  [[nodiscard]] const Strength& bestFound() const { return best_found_; }

 private:
  static constexpr double kCohesion_n = 0.3;
  [[nodiscard]] static Contact toContact(const Eigen::Vector2d& point) { return {point.x(), kCohesion_n * point.y()}; }
  [[nodiscard]] static Eigen::Vector2d toPoint(const Contact& contact) {
    return {contact.friction, contact.cohesion_n / kCohesion_n};
  }

  Strength wanted_;
  bool cohesive_;
  Eigen::Vector2d at_, before_, error_before_, best_;
  Eigen::Matrix2d slopes_;
  int steps_ = 0;
  double best_error_ = std::numeric_limits<double>::infinity();
  Strength best_found_;
};

SoilParameters withContact(SoilParameters soil, const Contact& contact) {
  soil.contact_friction = contact.friction;
  soil.contact_cohesion_n = contact.cohesion_n * std::pow(soil.radius_m / kTableRadius_m, 2);
  return soil;
}

/// k with which a contact that carries the stress `pressure_pa` of its particle's cross-section gives way by 2.8 % of
/// R.
double stiffnessFor(double pressure_pa, double radius_m) {
  constexpr double kOverlap = 0.028;
  return 4 * radius_m * pressure_pa / kOverlap;
}

/// rho0 and rho_max, in their ratio, for which a settled column has the wanted mean density over its upper 15 cm.
/// Contacts have no part in their scale, so neither has strength.
double calibrateDensity(SoilParameters& soil, double bulk_density, const CalibrateSoilOptions& options) {
  constexpr double kDepth_m = 0.15;
  constexpr int kMostRounds = 3;
  constexpr double kTolerance = 0.005;
  double reached = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    const LabConditions column{soil, options.gravity_m_s2, options.seed, options.threads, options.progress};
    reached = settleTest(column).meanDensity(kDepth_m);
    if (std::abs(reached / bulk_density - 1) < kTolerance) {
      break;
    }
    if (round + 1 < kMostRounds) {
      soil.rho0_kg_m3 *= bulk_density / reached;
      soil.rho_max_kg_m3 *= bulk_density / reached;
    }
  }
  return reached;
}

/// Strengths of specimens with some seeds.
std::vector<Strength> shear(const SoilParameters& soil, SoilStrength kind, const CalibrateSoilOptions& options,
                            std::uint64_t first_seed, int seeds) {
  std::vector<Strength> strengths;
  for (int i = 0; i < seeds; ++i) {
    const LabConditions conditions{soil, options.gravity_m_s2, first_seed + static_cast<std::uint64_t>(i),
                                   options.threads, options.progress};
    const ShearResult result = shearTest(conditions, options.shear);
    const MohrCoulomb& line = kind == SoilStrength::kPeak ? result.peak : result.residual;
    strengths.push_back({degrees(line.friction_angle_rad), line.cohesion_pa});
  }
  return strengths;
}

double mean(const std::vector<Strength>& strengths, double Strength::*what) {
  double sum = 0;
  for (const Strength& strength : strengths) {
    sum += strength.*what;
  }
  return sum / static_cast<double>(strengths.size());
}

double standardDeviation(const std::vector<Strength>& strengths, double Strength::*what) {
  const double middle = mean(strengths, what);
  double sum = 0;
  for (const Strength& strength : strengths) {
    sum += std::pow(strength.*what - middle, 2);
  }
  return std::sqrt(sum / static_cast<double>(strengths.size() - 1));
}

void validate(const SoilTarget& target, const CalibrateSoilOptions& options) {
  requireInRange("friction_angle_deg", target.friction_angle_deg, {kLeastFrictionAngle_deg, kMostFrictionAngle_deg});
  requireInRange("cohesion_pa", target.cohesion_pa, {0, kMostCohesion_pa});
  requireInRange("bulk_density_kg_m3", target.bulk_density_kg_m3, {800, 3000});
  requireInRange("radius_m", options.radius_m, {0.5e-3, 20e-3});
  requireInRange("gravity_m_s2", options.gravity_m_s2, {0.01, 100});
  requireInRange("stiffness_n_m", options.stiffness_n_m, {0, 1e7});
  requireInRange("verification_seeds", options.verification_seeds, {2, 100});
  validate(options.shear);
}

}  // namespace

CalibratedSoil calibrateSoil(const SoilTarget& target, const CalibrateSoilOptions& options) {
  validate(target, options);
  constexpr int kSearchSeeds = 2;
  constexpr int kMostRounds = 7;
  const Table& table = target.strength == SoilStrength::kPeak ? kPeak : kResidual;
  const Strength wanted{target.friction_angle_deg, target.cohesion_pa};

  CalibratedSoil result;
  SoilParameters soil = rescaled(lunarContacts(), options.radius_m);
  soil.stiffness_n_m =
      options.stiffness_n_m > 0
          ? options.stiffness_n_m
          : stiffnessFor(*std::ranges::max_element(options.shear.normal_stresses_pa), options.radius_m);
  soil.rho0_kg_m3 *= target.bulk_density_kg_m3 / kTableDensity_kg_m3;
  soil.rho_max_kg_m3 *= target.bulk_density_kg_m3 / kTableDensity_kg_m3;

  ContactSearch search(table, wanted);
  bool good = false;
  while (!good && result.rounds < kMostRounds) {
    const std::vector<Strength> measured =
        shear(withContact(soil, search.contact()), target.strength, options, options.seed, kSearchSeeds);
    good = search.learn({mean(measured, &Strength::angle_deg), mean(measured, &Strength::cohesion_pa)});
    ++result.rounds;
  }
  const Strength& found = search.bestFound();
  if (std::abs(found.angle_deg - wanted.angle_deg) > 3 ||
      std::abs(found.cohesion_pa - wanted.cohesion_pa) > std::max(0.3 * wanted.cohesion_pa, 100.0)) {
    throw InvalidParameter("friction_angle_deg with cohesion_pa",
                           fmt::format("{:g} with {:g}", wanted.angle_deg, wanted.cohesion_pa),
                           fmt::format("within reach of contacts; these gave {:.1f} with {:.0f} at best",
                                       found.angle_deg, found.cohesion_pa));
  }
  result.soil = withContact(soil, search.best());
  result.soil.mu_hat = std::tan(wanted.angle_deg * std::numbers::pi / 180) / std::sqrt(6.0);  // (paper 17)
  result.reached.bulk_density_kg_m3 = calibrateDensity(result.soil, target.bulk_density_kg_m3, options);

  const std::vector<Strength> verified =
      shear(result.soil, target.strength, options, options.seed + 1000, options.verification_seeds);
  result.reached.friction_angle_deg = mean(verified, &Strength::angle_deg);
  result.reached.friction_angle_sd_deg = standardDeviation(verified, &Strength::angle_deg);
  result.reached.cohesion_pa = mean(verified, &Strength::cohesion_pa);
  result.reached.cohesion_sd_pa = standardDeviation(verified, &Strength::cohesion_pa);
  result.reached.seeds = options.verification_seeds;
  return result;
}

}  // namespace haptolith
