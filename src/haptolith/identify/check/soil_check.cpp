#include "haptolith/identify/check/soil_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/core/math/random.h"
#include "haptolith/core/statistics.h"

namespace haptolith {

namespace {

/// Estimates and true values of one quantity.
struct Told {
  double truth;
  SoilEstimate estimate;
};

CheckedNumber over(std::string name, std::string unit, int decimals, const std::vector<Told>& soils,
                   bool in_parts = false) {
  std::vector<double> errors;
  double held = 0;
  for (const auto& [truth, estimate] : soils) {
    errors.push_back(std::abs(estimate.middle - truth) / (in_parts ? truth / 100 : 1));
    held += holds(estimate, truth) ? 1 : 0;
  }
  const double share = soils.empty() ? 0 : held / static_cast<double>(soils.size());
  return {std::move(name), std::move(unit), decimals, errors.empty() ? 0 : median(std::move(errors)), share};
}

}  // namespace

SoilCheck::SoilCheck(const Training& training, const Training& hidden) {
  const SoilIdentifier identifier(training);
  for (const TrainingRun& run : hidden.runs) {
    if (!run.strength) {
      throw InvalidParameter(fmt::format("soil {}", run.number), "not sheared",
                             "sheared: its strength has to be known");
    }
    MeasuredForces forces = measuredForces(run, kNoise_n, run.number);
    std::mt19937_64 random(run.number);
    const Vec3 bias_n =
        kBias_n * std::numbers::sqrt3 * Vec3{uniformSigned(random), uniformSigned(random), uniformSigned(random)};
    for (std::optional<Vec3>& force_n : forces) {
      *force_n += bias_n;
    }
    CheckedSoil soil;
    soil.number = run.number;
    soil.has_stone = run.sample.stone_size_m > 0;
    soil.truth = measuredState(run);
    soil.tool_friction_angle_deg = std::atan(run.sample.tool_friction) * 180 / std::numbers::pi;
    soil.belief = identifier.identify(forces, hidden.gravity_m_s2);
    soils_.push_back(soil);
  }
}

std::vector<CheckedNumber> SoilCheck::numbers(bool with_stones) const {
  std::vector<Told> angles, cohesions, larger, tool;
  constexpr double kLarge_pa = 250;  // 20 % of it are 50 Pa
  for (const CheckedSoil& soil : soils_) {
    if (soil.has_stone && !with_stones) {
      continue;
    }
    angles.push_back({soil.truth.friction_angle_deg, soil.belief.friction_angle_deg});
    tool.push_back({soil.tool_friction_angle_deg, soil.belief.tool_friction_angle_deg});
    const Told cohesion{soil.truth.cohesion_pa, soil.belief.cohesion_pa};
    cohesions.push_back(cohesion);
    if (cohesion.truth >= kLarge_pa) {
      larger.push_back(cohesion);
    }
  }
  return {over("friction angle", "°", 1, angles), over("cohesion", " Pa", 0, cohesions),
          over("cohesion of 250 Pa and more", " %", 0, larger, true), over("soil-tool friction", "°", 1, tool)};
}

int SoilCheck::strange() const {
  return static_cast<int>(
      std::ranges::count_if(soils_, [](const CheckedSoil& soil) { return soil.belief.misfit > kStrange; }));
}

}  // namespace haptolith
