#include "haptolith/bed/critical_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

constexpr double kPaperPhase = 1.0;  // dt * omega; the step is stable up to 2, and accurate enough up to 1

/// The same with contact friction. Where nothing damps, what a step gets wrong adds up: a shaken, frictionless bed that
/// coheres gains 5 % of its energy in 2 s at 0.8, 9 % at 1 and 23 % at 1.3. A hundredth of critical damping takes away
/// more than that.
double largestPhase(double damping_ratio) {
  return std::min(0.8 + 8 * damping_ratio, 1.2);
}

/// Largest eigenvalue of a packing whose contacts are 1 stiff along their normals and `across` beside them, walls
/// included: chords between the most that beds of the named soils have under a plate with 10 kPa, twice what 12 N on a
/// shovel come to. The largest eigenvalue is a convex function of `across`, so no chord is below it. This is the
/// margin: of what this allows a tool takes 0.88 at most with 12 N, 0.94 with 40 N, and a plate with 10 kPa 0.98; but
/// one with 30 kPa up to 1.10, and with 60 kPa soil trembles (docs/performance.md). A close crystal in which all twelve
/// contacts were as stiff as k would have 8 + 8 across; a bed would have to be pressed much harder for that.
double packing(double across) {
  constexpr double kNone = 6.0, kHalf = 10.2, kEqual = 15.9;  // across = 0, 1/2, 1
  return std::max(std::lerp(kNone, kHalf, 2 * across), std::lerp(kHalf, kEqual, 2 * across - 1));
}

/// The stiffest a contact gets: k, or where cohesion sets in, 4 F_c / range.
double contactStiffness(const SoilParameters& soil) {
  return std::max(soil.stiffness_n_m, 4 * soil.contact_cohesion_n / (soil.cohesion_range_ratio * soil.radius_m));
}

/// Of contacts with friction, what dt^2 K and 2 dt C of the step are over m, with q = dt sqrt(k / m): springs q^2,
/// dampers q. A damper is c = zeta sqrt(2 m k), along with k and across with k_t.
struct Contacts {
  double springs, dampers, phase;

  explicit Contacts(const SoilParameters& soil)
      : springs(packing(soil.tangential_ratio)),
        dampers(2 * soil.damping_ratio * std::numbers::sqrt2 * packing(std::sqrt(soil.tangential_ratio))),
        phase(largestPhase(soil.damping_ratio)) {}

  /// The largest q that is stable, springs q^2 + dampers q + tool <= 4, and accurate enough, springs q^2 + tool <=
  /// phase^2; `tool` is dt^2 k_tool / m. Not a number when the tool alone is too stiff.
  [[nodiscard]] double largest(double tool) const {
    const double stable = (std::sqrt(dampers * dampers + 4 * springs * (4 - tool)) - dampers) / (2 * springs);
    return std::min(std::sqrt((phase * phase - tool) / springs), stable);  // not a number stays it
  }

  /// The longest such dt, in s, of a rate sqrt(k / m) in 1/s and a tool's k_tool / m in 1/s^2.
  [[nodiscard]] double longestStep(double rate_per_s, double tool_per_s2) const {
    const double stiff = springs * rate_per_s * rate_per_s + tool_per_s2;
    const double damped = dampers * rate_per_s;
    return std::min((std::sqrt(damped * damped + 16 * stiff) - damped) / (2 * stiff), phase / std::sqrt(stiff));
  }
};

}  // namespace

double stepsPerSecond(const SoilParameters& soil, double tool_stiffness_n_m) {
  const double mass_kg = macroparticleMass(soil);
  if (soil.friction == FrictionModel::kContact) {
    return 1 / Contacts(soil).longestStep(std::sqrt(contactStiffness(soil) / mass_kg), tool_stiffness_n_m / mass_kg);
  }
  return std::sqrt((10 * soil.stiffness_n_m + tool_stiffness_n_m) / mass_kg) / kPaperPhase;
}

namespace {

/// The stiffest contact that `steps_per_s` are enough for, in N/m; not a number or negative when the tool alone needs
/// more.
double stiffestFor(const SoilParameters& soil, double tool_stiffness_n_m, double steps_per_s) {
  const double mass_kg = macroparticleMass(soil);
  if (soil.friction == FrictionModel::kContact) {
    const double q = Contacts(soil).largest(tool_stiffness_n_m / mass_kg / (steps_per_s * steps_per_s));
    return std::pow(q * steps_per_s, 2) * mass_kg;
  }
  return (std::pow(steps_per_s * kPaperPhase, 2) * mass_kg - tool_stiffness_n_m) / 10;
}

}  // namespace

int substepsFor(const SoilParameters& soil, double tool_stiffness_n_m, double tick_s, int max_substeps) {
  const double needed = std::ceil(tick_s * stepsPerSecond(soil, tool_stiffness_n_m));
  if (!(needed <= max_substeps)) {
    const double softest = stiffestFor(soil, tool_stiffness_n_m, max_substeps / tick_s);
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

int substepsFor(const BedParameters& bed, double tool_stiffness_n_m) {
  const SoilParameters finest = finestSoil(bed);
  return substepsFor(finest, finest.radius_m / bed.soil.radius_m * tool_stiffness_n_m, bed.tick_s, bed.max_substeps);
}

double sinkingTime(const SoilParameters& soil, double gravity_m_s2, double height_m, double dt_s) {
  if (soil.friction == FrictionModel::kContact || gravity_m_s2 == 0) {
    return 0;
  }
  constexpr double kNeighbours = 12;
  return height_m * kNeighbours * soil.stiffness_n_m * dt_s / (2 * macroparticleMass(soil) * gravity_m_s2);
}

}  // namespace haptolith
