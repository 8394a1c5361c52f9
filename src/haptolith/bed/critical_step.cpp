#include "haptolith/bed/critical_step.h"

#include <fmt/format.h>

#include <cmath>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {
constexpr double kLargestPhase = 1.0;  // dt * omega; the step is stable up to 2, and accurate enough up to 1
}

double highestFrequency(const SoilParameters& soil, double tool_stiffness_n_m) {
  return std::sqrt((10 * soil.stiffness_n_m + tool_stiffness_n_m) / macroparticleMass(soil));
}

int substepsFor(const SoilParameters& soil, double tool_stiffness_n_m, double tick_s, int max_substeps) {
  const double needed = std::ceil(tick_s * highestFrequency(soil, tool_stiffness_n_m) / kLargestPhase);
  if (!(needed <= max_substeps)) {
    const double allowed = std::pow(max_substeps * kLargestPhase / tick_s, 2) * macroparticleMass(soil);
    const double softest = (allowed - tool_stiffness_n_m) / 10;
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

}  // namespace haptolith
