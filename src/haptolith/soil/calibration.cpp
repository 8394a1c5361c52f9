#include "haptolith/soil/calibration.h"

#include <fmt/format.h>
#include <nlopt.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/math/portable_math.h"
#include "haptolith/soil/contact_law.h"
#include "haptolith/soil/layers.h"
#include "haptolith/soil/lunar_density.h"
#include "haptolith/soil/strength.h"

namespace haptolith {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The law begins at 1270 kg/m^3 and the paper's sets at 1270 to 1400: room on both sides.
constexpr double kLeastCalibratedRho0 = 1000;  // kg/m^3
constexpr double kMostRho0 = 1600;
// The rock itself has about 3100 kg/m^3. No fit to the lunar law comes near this bound.
constexpr double kMostRhoMax = 2600;

// Largest part of the way to a_min that compaction to rho_1 may use. Nearer to a_min the cohesion of (paper 18) grows
// without limit and the search would buy any cohesion there with a soil that is nothing like one. The paper's sets use
// 0.57 to 0.72.
constexpr double kMostOverlap = 0.9;

// kg/m^3; worse than any soil, and finite, because DIRECT averages.
constexpr double kImpossible = 1e5;

/// Variables of the search. Both run from 0 to 1, so that every point of the square is a soil that can be compacted.
struct Shape {
  double rho0 = 0;     ///< from kLeastCalibratedRho0 to kMostRho0
  double rho_max = 0;  ///< from leastCompactableRhoMax() to kMostRhoMax
};

SoilParameters soilOf(const CalibrationTarget& target, const Shape& shape) {
  SoilParameters soil;
  soil.radius_m = target.radius_m;
  soil.stiffness_n_m = target.stiffness_n_m;
  soil.mu_hat = modelFriction(target.friction_coefficient);
  soil.rho0_kg_m3 = std::lerp(kLeastCalibratedRho0, kMostRho0, shape.rho0);
  soil.rho_max_kg_m3 = std::lerp(leastCompactableRhoMax(soil.rho0_kg_m3, kMostOverlap), kMostRhoMax, shape.rho_max);
  return soil;
}

/// The soil with k infinite and gamma = 1 N m: what scales with gamma, per unit of it.
SoilParameters unitSoil(SoilParameters soil) {
  soil.stiffness_n_m = kInfinity;
  soil.gamma_nm = 1;
  return soil;
}

/// The largest gamma for which a spring k is still stiffer than the hyperbola at 2R, see makeContactLaw().
double mostGamma(const SoilParameters& soil, double stiffness_n_m) {
  return stiffness_n_m * portable::square(2 * soil.radius_m - makeContactLaw(unitSoil(soil)).a_min_m);
}

/// The stiffness a bed of this soil has to do with: the target's, or when that is infinite the paper's.
double renderedStiffness(const CalibrationTarget& target) {
  return std::isfinite(target.stiffness_n_m) ? target.stiffness_n_m
                                             : rescaled(SoilParameters{}, target.radius_m).stiffness_n_m;
}

SoilParameters withCohesion(SoilParameters soil, double cohesion_pa) {
  soil.gamma_nm = cohesion_pa / cohesion(unitSoil(soil));
  return soil;
}

double misfit(const CalibrationTarget& target, const Shape& shape) {
  const SoilParameters soil = withCohesion(soilOf(target, shape), target.cohesion_pa);
  if (soil.gamma_nm >= mostGamma(soil, renderedStiffness(target))) {
    return kImpossible;
  }
  try {
    return lunarDensityRms(soil, target.gravity_m_s2);
  } catch (const Failure&) {  // collapses under its own weight
    return kImpossible;
  }
}

/// Runs one of NLopt's searches from `start` and returns the best shape it saw.
Shape search(const CalibrationTarget& target, nlopt::algorithm algorithm, const Shape& start, int evaluations) {
  struct Best {
    const CalibrationTarget* target;
    Shape shape;
    double misfit;
  } best{&target, start, misfit(target, start)};

  nlopt::opt search(algorithm, 2);
  search.set_lower_bounds(0);
  search.set_upper_bounds(1);
  search.set_min_objective(
      [](unsigned, const double* x, double*, void* data) {
        Best& seen = *static_cast<Best*>(data);
        const Shape shape{x[0], x[1]};
        const double value = misfit(*seen.target, shape);
        if (value < seen.misfit) {
          seen.shape = shape;
          seen.misfit = value;
        }
        return value;
      },
      &best);
  search.set_maxeval(evaluations);
  search.set_xtol_abs(1e-7);
  std::vector<double> x{start.rho0, start.rho_max};
  double ignored = 0;
  try {
    search.optimize(x, ignored);
  } catch (const nlopt::roundoff_limited&) {  // as good as it gets; `best` has it
  }
  return best.shape;
}

/// The most cohesion that any shape reaches, in Pa.
double mostCohesion(const CalibrationTarget& target) {
  constexpr int kSteps = 50;
  double most = 0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const SoilParameters soil = soilOf(target, {double(i) / kSteps, double(j) / kSteps});
      most = std::max(most, mostGamma(soil, renderedStiffness(target)) * cohesion(unitSoil(soil)));
    }
  }
  return most;
}

void validate(const CalibrationTarget& target) {
  requireInRange("friction_coefficient", target.friction_coefficient, {0, 2, Ends::kOpenBelow});
  requireInRange("gravity_m_s2", target.gravity_m_s2, {0, 1000, Ends::kOpenBelow});
  requireInRange("radius_m", target.radius_m, {0.5e-3, 20e-3});
  if (target.stiffness_n_m != kInfinity) {
    requireInRange("stiffness_n_m", target.stiffness_n_m, {0, kInfinity, Ends::kOpen});
  }
  const double most = mostCohesion(target);
  if (!(target.cohesion_pa > 0 && target.cohesion_pa < most)) {
    throw InvalidParameter(
        "cohesion_pa", fmt::format("{}", target.cohesion_pa),
        fmt::format("> 0 and < {:.0f}, the most that is reached with friction_coefficient = {} and a "
                    "stiffness of {:.4g} N/m",
                    most, target.friction_coefficient, renderedStiffness(target)));
  }
}

}  // namespace

double lunarDensityRms(const SoilParameters& soil, double gravity_m_s2) {
  double sum = 0;
  for (const Layer& layer : layersToDepth(soil, gravity_m_s2, kLunarLawDepthM)) {
    const double bottom = std::min(layer.bottom_m, kLunarLawDepthM);
    const double difference = layer.density_kg_m3 - lunarMeanBulkDensity(layer.top_m, bottom);
    sum += (bottom - layer.top_m) * difference * difference;
  }
  return std::sqrt(sum / kLunarLawDepthM);
}

Calibration calibrate(const CalibrationTarget& target) {
  validate(target);
  const Shape rough = search(target, nlopt::GN_DIRECT_L, {0.5, 0.5}, 400);
  const Shape best = search(target, nlopt::LN_SBPLX, rough, 400);

  Calibration result;
  result.soil = withCohesion(soilOf(target, best), target.cohesion_pa);
  result.cohesion_pa = cohesion(result.soil);
  result.density_rms_kg_m3 = lunarDensityRms(result.soil, target.gravity_m_s2);
  return result;
}

}  // namespace haptolith
