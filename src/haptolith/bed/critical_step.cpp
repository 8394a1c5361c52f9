#include "haptolith/bed/critical_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {
constexpr double kLargestPhase = 1.0;  // dt * omega; the step is stable up to 2, and accurate enough up to 1

/// The stiffest a contact gets: k, or where cohesion sets in, 4 F_c / range.
double contactStiffness(const SoilParameters& soil) {
  if (soil.friction != FrictionModel::kContact) {
    return soil.stiffness_n_m;
  }
  return std::max(soil.stiffness_n_m, 4 * soil.contact_cohesion_n / (soil.cohesion_range_ratio * soil.radius_m));
}

/// 1, and with contact friction 1 + k_t / k.
double withTangent(const SoilParameters& soil) {
  return soil.friction == FrictionModel::kContact ? 1 + soil.tangential_ratio : 1;
}

/// dt * omega that is still well inside the step's limit. Damping that acts on the last velocity lowers that from 2 to
/// 2 (sqrt(1 + z^2) - z), where z = 2 zeta is the damping ratio of the fastest mode.
double largestPhase(const SoilParameters& soil) {
  if (soil.friction != FrictionModel::kContact) {
    return kLargestPhase;
  }
  constexpr double kShareOfLimit = 0.75;
  const double z = 2 * soil.damping_ratio;
  return std::min(kLargestPhase, kShareOfLimit * 2 * (std::sqrt(1 + z * z) - z));
}

}  // namespace

double highestFrequency(const SoilParameters& soil, double tool_stiffness_n_m) {
  const double stiffness = (10 * contactStiffness(soil) + tool_stiffness_n_m) * withTangent(soil);
  return std::sqrt(stiffness / macroparticleMass(soil));
}

int substepsFor(const SoilParameters& soil, double tool_stiffness_n_m, double tick_s, int max_substeps) {
  const double needed = std::ceil(tick_s * highestFrequency(soil, tool_stiffness_n_m) / largestPhase(soil));
  if (!(needed <= max_substeps)) {
    const double allowed = std::pow(max_substeps * largestPhase(soil) / tick_s, 2) * macroparticleMass(soil);
    const double softest = (allowed / withTangent(soil) - tool_stiffness_n_m) / 10;
    if (softest > soil.stiffness_n_m) {  // it is cohesion that is too stiff
      throw InvalidParameter(
          "contact_cohesion_n", fmt::format("{:g}", soil.contact_cohesion_n),
          fmt::format("<= {:.4g} with this range and macroparticles of {:g} mm (max_substeps = {})",
                      softest * soil.cohesion_range_ratio * soil.radius_m / 4, 1e3 * soil.radius_m, max_substeps));
    }
    throw InvalidParameter(
        "stiffness_n_m", fmt::format("{:g}", soil.stiffness_n_m),
        softest > 0 ? fmt::format("<= {:.4g} for macroparticles of {:g} mm ({:g} g), which would "
                                  "else need {:g} substeps a tick (max_substeps = {})",
                                  softest, 1e3 * soil.radius_m, 1e3 * macroparticleMass(soil), needed, max_substeps)
                    : fmt::format("paired with a softer tool, larger macroparticles or more "
                                  "substeps: {:g} would be needed (max_substeps = {})",
                                  needed, max_substeps));
  }
  return std::max(1, static_cast<int>(needed));
}

double sinkingTime(const SoilParameters& soil, double gravity_m_s2, double height_m, double dt_s) {
  if (soil.friction == FrictionModel::kContact || gravity_m_s2 == 0) {
    return 0;
  }
  constexpr double kNeighbours = 12;
  return height_m * kNeighbours * soil.stiffness_n_m * dt_s / (2 * macroparticleMass(soil) * gravity_m_s2);
}

}  // namespace haptolith
