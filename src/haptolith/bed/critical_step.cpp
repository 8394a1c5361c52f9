#include "haptolith/bed/critical_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "haptolith/bed/grain_classes.h"
#include "haptolith/core/assert.h"
#include "haptolith/core/error.h"
#include "haptolith/core/math/portable_math.h"

namespace haptolith {

namespace {

constexpr double kPaperPhase = 1.0;  // dt * omega; the step is stable up to 2, and accurate enough up to 1

/// As above with contact friction. Without damping the errors of the steps add up: a shaken, frictionless bed that
/// coheres gains 5 % of its energy in 2 s at 0.8, 9 % at 1 and 23 % at 1.3. A hundredth of critical damping takes away
/// more than that.
double largestPhase(double damping_ratio) {
  HAPTO_ASSERT(damping_ratio >= 0);
  return std::min(0.8 + 8 * damping_ratio, 1.2);
}

/// Largest eigenvalue of a packing whose contacts have stiffness 1 along their normals and `across` tangentially, walls
/// included: chords between the most that beds of the named soils have under a plate with 10 kPa, twice what 12 N on a
/// shovel come to. The largest eigenvalue is a convex function of `across`, so no chord is below it. This is the
/// margin: of what this allows a tool takes 0.88 at most with 12 N, 0.94 with 40 N, and a plate with 10 kPa 0.98; but
/// one with 30 kPa up to 1.10, and with 60 kPa soil trembles (docs/reports/performance.md). A close crystal in which
/// all twelve contacts were as stiff as k would have 8 + 8 across; a bed would have to be pressed much harder for that.
double packing(double across) {
  constexpr double kNone = 6.0, kHalf = 10.2, kEqual = 15.9;  // across = 0, 1/2, 1
  return std::max(std::lerp(kNone, kHalf, 2 * across), std::lerp(kHalf, kEqual, 2 * across - 1));
}

/// The stiffest a contact gets: k, or where cohesion sets in, 4 F_c / range.
double contactStiffness(const SoilParameters& soil) {
  return std::max(soil.stiffness_n_m, 4 * soil.contact_cohesion_n / (soil.cohesion_range_ratio * soil.radius_m));
}

/// The longest step, in s, that is stable, dt^2 stiff + dt damped <= 4, and accurate enough, dt^2 stiff <= phase^2.
/// @param stiff  largest eigenvalue of the springs over masses, in 1/s^2. @param damped  twice that of dampers, in 1/s.
double longestStepOf(double stiff, double damped, double phase) {
  HAPTO_ASSERT(stiff > 0);
  HAPTO_ASSERT(damped >= 0);
  return std::min((std::sqrt(damped * damped + 16 * stiff) - damped) / (2 * stiff), phase / std::sqrt(stiff));
}

/// Contributions of contacts with friction to dt^2 K and 2 dt C over m, with q = dt sqrt(k / m): springs q^2,
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
    return longestStepOf(stiff, dampers * rate_per_s, phase);
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
    return portable::square(q * steps_per_s) * mass_kg;
  }
  return (portable::square(steps_per_s * kPaperPhase) * mass_kg - tool_stiffness_n_m) / 10;
}

}  // namespace

int substepsFor(const SoilParameters& soil, double tool_stiffness_n_m, double tick_s, int max_substeps) {
  HAPTO_ASSERT(tick_s > 0);
  HAPTO_ASSERT(max_substeps >= 1);
  const double needed = std::ceil(tick_s * stepsPerSecond(soil, tool_stiffness_n_m));
  if (!(needed <= max_substeps)) {
    const double softest = stiffestFor(soil, tool_stiffness_n_m, max_substeps / tick_s);
    if (softest > soil.stiffness_n_m) {  // it is cohesion that is too stiff
      throw InvalidParameter(
          "contact_cohesion_n", fmt::format("{:g}", soil.contact_cohesion_n),
          fmt::format("<= {:.4g} with this range and particles of R = {:g} mm (max_substeps = {})",
                      softest * soil.cohesion_range_ratio * soil.radius_m / 4, 1e3 * soil.radius_m, max_substeps));
    }
    throw InvalidParameter(
        "stiffness_n_m", fmt::format("{:g}", soil.stiffness_n_m),
        softest > 0 ? fmt::format("<= {:.4g} for particles of R = {:g} mm ({:g} g); this value needs {:g} substeps per "
                                  "tick (max_substeps = {})",
                                  softest, 1e3 * soil.radius_m, 1e3 * macroparticleMass(soil), needed, max_substeps)
                    : fmt::format("combined with a softer tool, larger particles or more substeps: {:g} substeps are "
                                  "needed (max_substeps = {})",
                                  needed, max_substeps));
  }
  return std::max(1, static_cast<int>(needed));
}

namespace {

double ballMass(double density_kg_m3, double diameter_m) {
  return density_kg_m3 * std::numbers::pi / 6 * diameter_m * diameter_m * diameter_m;
}

/// A stone as the number of steps depends on it.
struct StoneOfStep {
  std::string key;    ///< key of its size in a scene file
  double size_m = 0;  ///< diameter of the sphere of its volume, or less
  bool fixed = false;
};

/// Diameter of a sphere whose volume the union of these has at least: that of those that do not touch, the largest
/// first.
double sizeOfUnion(std::vector<StoneSphere> spheres) {
  std::ranges::sort(spheres, std::greater(), &StoneSphere::radius_m);
  std::vector<StoneSphere> apart;
  double cubes_m3 = 0;
  for (const StoneSphere& sphere : spheres) {
    const bool touches = std::ranges::any_of(apart, [&](const StoneSphere& other) {
      return (other.centre_m - sphere.centre_m).norm() < other.radius_m + sphere.radius_m;
    });
    if (!touches) {
      apart.push_back(sphere);
      cubes_m3 += portable::cube(sphere.radius_m);
    }
  }
  return 2 * portable::cbrt(cubes_m3);
}

/// The placed stones, and of those at random places the smallest and the largest.
std::vector<StoneOfStep> stonesOfStep(const StonesParameters& stones) {
  std::vector<StoneOfStep> all;
  for (std::size_t i = 0; i < stones.placed.size(); ++i) {
    const PlacedStone& stone = stones.placed[i];
    const bool of_spheres = stone.form == StoneForm::kSpheres;
    all.push_back({fmt::format("{} of stone {}", of_spheres ? "spheres_mm" : "size_mm", i + 1),
                   of_spheres ? sizeOfUnion(stone.spheres) : stone.size_m, stone.fixed});
  }
  if (stones.count > 0) {
    all.push_back({"stones.smallest_mm", stones.smallest_m, stones.fixed});
  }
  if (stones.count > 1) {
    all.push_back({"stones.largest_mm", stones.largest_m, stones.fixed});
  }
  return all;
}

/// Bodies that a stone touches: grains of one class, or other stones.
struct Neighbours {
  double radius_m, mass_kg;
  double stiffness_n_m;  ///< stiffness of one contact
};

/// Steps per second that a stone among such neighbours needs.
///
/// A stone of radius r and mass M among others of radius R and mass m is held by n contacts of
///
///     k' = k 2 r R / (r + R) over the soil's radius,   c' = zeta sqrt(4 m M / (m + M) k')
///
/// (StoneContactLaw), and each of the others moves against it by one of them:
///
///     stiff = n g(k_t / k) k' / M + k' / m,   damped = 2 (n g(sqrt(k_t / k)) c' / M + c' / m)
///
/// n: nine on a sphere of equal size (packing(): 6 = 2 n / 3 without friction, neighbours moving the other way),
/// and more in proportion to the room around a larger one, (r + R)^2 / 4 R^2; half of nine around the smallest. g: how
/// a stone turns about itself, 5/3 of each contact's k_t, and by contacts that do not point to its middle. A tool adds
/// what it presses on several spheres.
double stepsBeside(const SoilParameters& soil, double size_m, double mass_kg, const Neighbours& others,
                   double tool_stiffness_n_m) {
  constexpr double kAround = 9, kLeastAround = 4.5;
  constexpr double kSpheresAtTool = 3;
  const auto for_turning = [](double across) { return 0.4 + 5.0 / 3 * across; };
  const double wider = (size_m / 2 + others.radius_m) / (2 * others.radius_m);
  const double around = std::max(kAround * wider * wider, kLeastAround);
  const double damper =
      soil.damping_ratio * std::sqrt(4 * others.mass_kg * mass_kg / (others.mass_kg + mass_kg) * others.stiffness_n_m);
  const double stiff =
      others.stiffness_n_m * (around * for_turning(soil.tangential_ratio) / mass_kg + 1 / others.mass_kg) +
      kSpheresAtTool * tool_stiffness_n_m / mass_kg;
  const double damped =
      2 * damper * (around * for_turning(std::sqrt(soil.tangential_ratio)) / mass_kg + 1 / others.mass_kg);
  return 1 / longestStepOf(stiff, damped, largestPhase(soil.damping_ratio));
}

constexpr double kImmovable_kg = 1e30;

/// Maximum over everything that the stone may touch in a bed.
double stepsForStone(const BedParameters& bed, double size_m, double tool_stiffness_n_m) {
  const SoilParameters& soil = bed.soil;
  const double mass_kg = ballMass(bed.stones.density_kg_m3, size_m);
  const auto between = [&](double radius_m) {  // k'
    return soil.stiffness_n_m * size_m * radius_m / (size_m / 2 + radius_m) / soil.radius_m;
  };
  double needed = 0;
  for (int c = 0; c < grainClasses(bed); ++c) {
    const SoilParameters grains = rescaled(soil, GrainClasses::scale(c) * soil.radius_m);
    const double cohesion_n_m = 4 * grains.contact_cohesion_n / (grains.cohesion_range_ratio * grains.radius_m);
    needed = std::max(needed, stepsBeside(soil, size_m, mass_kg,
                                          {.radius_m = grains.radius_m,
                                           .mass_kg = macroparticleMass(grains),
                                           .stiffness_n_m = std::max(between(grains.radius_m), cohesion_n_m)},
                                          tool_stiffness_n_m));
  }
  if (bed.stones.placed.size() + static_cast<std::size_t>(bed.stones.count) > 1) {
    for (const StoneOfStep& other : stonesOfStep(bed.stones)) {
      if (other.size_m < size_m) {
        continue;  // the smaller of two stones needs more steps
      }
      const double radius_m = other.size_m / 2;
      const double other_kg = other.fixed ? kImmovable_kg : ballMass(bed.stones.density_kg_m3, other.size_m);
      needed = std::max(
          needed, stepsBeside(soil, size_m, mass_kg, {radius_m, other_kg, between(radius_m)}, tool_stiffness_n_m));
    }
  }
  return needed;
}

/// The stone that needs the most steps, and how many; none without one that moves.
struct LightestStone {
  StoneOfStep stone;
  double steps_per_s = 0;
};
LightestStone lightestStone(const BedParameters& bed, double tool_stiffness_n_m) {
  LightestStone lightest;
  for (const StoneOfStep& stone : stonesOfStep(bed.stones)) {
    if (!stone.fixed) {
      const double steps_per_s = stepsForStone(bed, stone.size_m, tool_stiffness_n_m);
      lightest = steps_per_s > lightest.steps_per_s ? LightestStone{stone, steps_per_s} : lightest;
    }
  }
  return lightest;
}

/// Size of the least stone that needs no more steps.
double leastStone(const BedParameters& bed, double size_m, double tool_stiffness_n_m, double steps_per_s) {
  constexpr double kCloseEnough = 1.0005;
  double too_small_m = size_m;
  double enough_m = kStoneSize_m.highest;
  while (enough_m > kCloseEnough * too_small_m) {
    const double middle_m = std::sqrt(too_small_m * enough_m);
    (stepsForStone(bed, middle_m, tool_stiffness_n_m) <= steps_per_s ? enough_m : too_small_m) = middle_m;
  }
  return enough_m;
}

}  // namespace

double stepsPerSecond(const BedParameters& bed, double tool_stiffness_n_m) {
  const SoilParameters finest = finestSoil(bed);
  return std::max(stepsPerSecond(finest, finest.radius_m / bed.soil.radius_m * tool_stiffness_n_m),
                  lightestStone(bed, tool_stiffness_n_m).steps_per_s);
}

int substepsFor(const BedParameters& bed, double tool_stiffness_n_m) {
  const SoilParameters finest = finestSoil(bed);
  const int for_soil =
      substepsFor(finest, finest.radius_m / bed.soil.radius_m * tool_stiffness_n_m, bed.tick_s, bed.max_substeps);
  const auto [stone, steps_per_s] = lightestStone(bed, tool_stiffness_n_m);
  const double needed = std::ceil(bed.tick_s * steps_per_s);
  if (!(needed <= bed.max_substeps)) {
    const double least_m = leastStone(bed, stone.size_m, tool_stiffness_n_m, bed.max_substeps / bed.tick_s);
    throw InvalidParameter(
        stone.key, fmt::format("{:.4g}", 1e3 * stone.size_m),
        fmt::format(">= {:.3g} (mm, sphere of equal volume) at {:g} kg/m3 among particles of R = {:g} mm: a lighter "
                    "stone needs {:g} substeps per tick (max_substeps = {})",
                    1e3 * least_m, bed.stones.density_kg_m3, 1e3 * bed.soil.radius_m, needed, bed.max_substeps));
  }
  return std::max(for_soil, static_cast<int>(needed));
}

double sinkingTime(const SoilParameters& soil, double gravity_m_s2, double height_m, double dt_s) {
  if (soil.friction == FrictionModel::kContact || gravity_m_s2 == 0) {
    return 0;
  }
  constexpr double kNeighbours = 12;
  return height_m * kNeighbours * soil.stiffness_n_m * dt_s / (2 * macroparticleMass(soil) * gravity_m_s2);
}

}  // namespace haptolith
