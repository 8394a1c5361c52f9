#include "haptolith/lab/report/calibrate_soil.h"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/lab/apparatus/settle.h"
#include "haptolith/lab/report/specimen_statistics.h"
#include "haptolith/lab/staged_progress.h"
#include "haptolith/soil/contact_law.h"
#include "haptolith/soil/contact_strength.h"

namespace haptolith {

namespace {

constexpr double kTableDensity_kg_m3 = 1500;  ///< density of lunarContacts() in the upper 15 cm, on the Moon

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

/// Difference of two strengths, each component over its tolerance.
Eigen::Vector2d distance(const ShearStrength& from, const ShearStrength& to) {
  constexpr double kAngle_deg = 0.5;
  const double cohesion_pa = std::max(0.06 * to.cohesion_pa, 20.0);
  return {(from.angle_deg - to.angle_deg) / kAngle_deg, (from.cohesion_pa - to.cohesion_pa) / cohesion_pa};
}

/// Broyden's method (1965) for the contact with the wanted strength. Initial slopes come from the table; each shear
/// test updates them. Variables: friction, and cohesion over that of the table's third row.
class ContactSearch {
 public:
  ContactSearch(const ShearStrength& wanted, SoilStrength kind)
      : wanted_(wanted), cohesive_(wanted.cohesion_pa > 0), at_(toPoint(tabulatedContact(wanted, kind))) {
    constexpr double kStep = 0.02;
    const auto tabulated = [&](const Eigen::Vector2d& point) {
      return distance(tabulatedStrength(toContact(point), kind), wanted);
    };
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
      slopes_.col(axis) = (tabulated(at_ + step) - tabulated(at_ - step)) / (2 * kStep);
    }
    if (!cohesive_) {  // a cohesion of zero cannot be lowered
      slopes_.row(1) = slopes_.col(1).transpose() = Eigen::RowVector2d(0, 1);
    }
  }

  [[nodiscard]] ContactStrength contact() const { return toContact(at_); }

  /// Updates the search with the strength found for the current contact. Returns true when it is within tolerance.
  bool learn(const ShearStrength& found) {
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
    constexpr double kScatter = 0.01;  // a shorter step measures the specimens' scatter, not the slope
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

  [[nodiscard]] ContactStrength best() const { return toContact(best_); }
  [[nodiscard]] const ShearStrength& bestFound() const { return best_found_; }

 private:
  static constexpr double kCohesion_n = 0.3;
  [[nodiscard]] static ContactStrength toContact(const Eigen::Vector2d& point) {
    return {point.x(), kCohesion_n * point.y()};
  }
  [[nodiscard]] static Eigen::Vector2d toPoint(const ContactStrength& contact) {
    return {contact.friction, contact.cohesion_n / kCohesion_n};
  }

  ShearStrength wanted_;
  bool cohesive_;
  Eigen::Vector2d at_, before_, error_before_, best_;
  Eigen::Matrix2d slopes_;
  int steps_ = 0;
  double best_error_ = std::numeric_limits<double>::infinity();
  ShearStrength best_found_;
};

SoilParameters withContact(SoilParameters soil, const ContactStrength& contact) {
  soil.contact_friction = contact.friction;
  soil.contact_cohesion_n = contact.cohesion_n * std::pow(soil.radius_m / kTabulatedRadius_m, 2);
  return soil;
}

/// Returns k of a contact that carries 0.3 of the stress `largest_pa` over its particle's cross-section with an overlap
/// of 2.8 % of R, or 0.35 % for a linear spring. The strength at the largest stress then equals that with twice the
/// stiffness, within the scatter of specimens (docs/explanation/contact-model.md).
double stiffnessFor(double largest_pa, double radius_m, DensityProfile density) {
  const double overlap = density == DensityProfile::kLunar ? 0.028 : 0.0035;
  return 4 * radius_m * (0.3 * largest_pa) / overlap;
}

constexpr int kSearchSeeds = 2;

/// Progress of a calibration, in shear tests. The number of rounds of the search is not known; usually it is four.
class CalibrationProgress {
 public:
  explicit CalibrationProgress(const CalibrateSoilOptions& options)
      : stages_(options.progress), verified_(options.verification_seeds) {}

  /// Returns the progress of the next test, which takes as long as `tests` shear tests.
  [[nodiscard]] LabProgress next(double tests) {
    const double begin = std::min(done_, until_);
    done_ += tests;
    stages_.enter(begin / all(), std::min(done_, until_) / all());
    return [inner = stages_.inner(), stage = stage_](std::string_view what, double share) {
      return !inner || inner(stage + std::string(what), share);
    };
  }

  void round(int number) { stage_ = fmt::format("round {}, ", number + 1); }
  void density() { begin("density, ", kSearch, kSearch + kDensity); }
  void verification() { begin("verification, ", kSearch + kDensity, all()); }

 private:
  static constexpr double kSearch = 4 * kSearchSeeds, kDensity = 1;
  [[nodiscard]] double all() const { return kSearch + kDensity + verified_; }
  void begin(std::string_view stage, double from, double until) {
    stage_ = stage;
    done_ = from;
    until_ = until;
  }

  StagedProgress stages_;
  std::string stage_;
  double verified_, done_ = 0, until_ = kSearch;
};

/// Scales rho0 and rho_max together until a settled column has the wanted mean density over its upper 15 cm. Contacts
/// do not depend on the scale, so strength does not either.
double calibrateDensity(SoilParameters& soil, double bulk_density, const CalibrateSoilOptions& options,
                        CalibrationProgress& progress) {
  constexpr double kDepth_m = 0.15;
  constexpr int kMostRounds = 3;
  constexpr double kTolerance = 0.005;
  double reached = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    const LabConditions column{soil, options.gravity_m_s2, options.seed, options.threads, progress.next(0.5)};
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

/// Returns the strengths of specimens with consecutive seeds.
std::vector<ShearStrength> shear(const SoilParameters& soil, SoilStrength kind, const CalibrateSoilOptions& options,
                                 std::uint64_t first_seed, int seeds, CalibrationProgress& progress) {
  std::vector<ShearStrength> strengths;
  for (int i = 0; i < seeds; ++i) {
    const LabConditions conditions{soil, options.gravity_m_s2, first_seed + static_cast<std::uint64_t>(i),
                                   options.threads, progress.next(1)};
    const ShearResult result = shearTest(conditions, options.shear);
    const MohrCoulomb& line = kind == SoilStrength::kPeak ? result.peak : result.residual;
    strengths.push_back({degrees(line.friction_angle_rad), line.cohesion_pa});
  }
  return strengths;
}

Scatter scatterAmong(const std::vector<ShearStrength>& strengths, double ShearStrength::*what) {
  std::vector<double> numbers;
  std::ranges::transform(strengths, std::back_inserter(numbers), what);
  return scatterOf(numbers);
}

/// Returns the first of `specimens` seeds that no calibration from another seed uses for the same purpose; with seed 1
/// they begin at `from`.
std::uint64_t firstSeed(std::uint64_t from, std::uint64_t calibration_seed, int specimens) {
  return from + (calibration_seed - 1) * static_cast<std::uint64_t>(specimens);
}

void validate(const SoilTarget& target, const CalibrateSoilOptions& options) {
  requireInRange("friction_angle_deg", target.friction_angle_deg, {kLeastFrictionAngle_deg, kMostFrictionAngle_deg});
  requireInRange("cohesion_pa", target.cohesion_pa, {0, kMostCohesion_pa});
  requireInRange("bulk_density_kg_m3", target.bulk_density_kg_m3, {800, 3000});
  requireInRange("radius_m", options.radius_m, {0.5e-3, 20e-3});
  requireInRange("gravity_m_s2", options.gravity_m_s2, {0.01, 100});
  requireInRange("stiffness_n_m", options.stiffness_n_m, {0, 1e7});
  requireInRange("max_pressure_pa", options.max_pressure_pa, {100, 1e6});
  requireInRange("verification_seeds", options.verification_seeds, CalibrateSoilRanges::verification_seeds);
  validate(options.shear);
}

}  // namespace

CalibratedSoil calibrateSoil(const SoilTarget& target, const CalibrateSoilOptions& options) {
  validate(target, options);
  constexpr int kMostRounds = 7;
  CalibrationProgress progress(options);
  const ShearStrength wanted{target.friction_angle_deg, target.cohesion_pa};

  CalibratedSoil result;
  SoilParameters soil = rescaled(lunarContacts(), options.radius_m);
  soil.stiffness_n_m = options.stiffness_n_m > 0
                           ? options.stiffness_n_m
                           : stiffnessFor(options.max_pressure_pa, options.radius_m, options.density);
  soil.rho0_kg_m3 *= target.bulk_density_kg_m3 / kTableDensity_kg_m3;
  soil.rho_max_kg_m3 *= target.bulk_density_kg_m3 / kTableDensity_kg_m3;
  if (options.density == DensityProfile::kConstant) {
    soil.gamma_nm = linearGamma(soil);
  }

  const std::uint64_t search_seed = firstSeed(1, options.seed, kSearchSeeds);
  ContactSearch search(wanted, target.strength);
  bool good = false;
  while (!good && result.rounds < kMostRounds) {
    progress.round(result.rounds);
    const std::vector<ShearStrength> measured =
        shear(withContact(soil, search.contact()), target.strength, options, search_seed, kSearchSeeds, progress);
    good = search.learn({scatterAmong(measured, &ShearStrength::angle_deg).mean,
                         scatterAmong(measured, &ShearStrength::cohesion_pa).mean});
    ++result.rounds;
  }
  const ShearStrength& found = search.bestFound();
  if (std::abs(found.angle_deg - wanted.angle_deg) > 3 ||
      std::abs(found.cohesion_pa - wanted.cohesion_pa) > std::max(0.3 * wanted.cohesion_pa, 100.0)) {
    throw InvalidParameter("friction_angle_deg with cohesion_pa",
                           fmt::format("{:g} with {:g}", wanted.angle_deg, wanted.cohesion_pa),
                           fmt::format("within reach of contacts; these gave {:.1f} with {:.0f} at best",
                                       found.angle_deg, found.cohesion_pa));
  }
  result.soil = withContact(soil, search.best());
  result.soil.mu_hat = std::tan(wanted.angle_deg * std::numbers::pi / 180) / std::sqrt(6.0);  // (paper 17)
  progress.density();
  result.reached.bulk_density_kg_m3 = calibrateDensity(result.soil, target.bulk_density_kg_m3, options, progress);

  progress.verification();
  const std::vector<ShearStrength> verified =
      shear(result.soil, target.strength, options, firstSeed(1001, options.seed, options.verification_seeds),
            options.verification_seeds, progress);
  const Scatter angle_deg = scatterAmong(verified, &ShearStrength::angle_deg);
  const Scatter cohesion_pa = scatterAmong(verified, &ShearStrength::cohesion_pa);
  result.reached.friction_angle_deg = angle_deg.mean;
  result.reached.friction_angle_sd_deg = angle_deg.sd;
  result.reached.cohesion_pa = cohesion_pa.mean;
  result.reached.cohesion_sd_pa = cohesion_pa.sd;
  result.reached.seeds = options.verification_seeds;
  return result;
}

}  // namespace haptolith
