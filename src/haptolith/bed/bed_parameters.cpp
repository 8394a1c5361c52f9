#include "haptolith/bed/bed_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "haptolith/bed/cell_grid.h"
#include "haptolith/bed/grain_classes.h"
#include "haptolith/bed/kernel/kernel_law.h"
#include "haptolith/core/error.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

int grainClasses(const BedParameters& bed) {
  const double coarsest_m = bed.soil.radius_m;
  const double finest_m = bed.grading.fine_radius_m;
  if (finest_m == 0) {
    return 1;
  }
  constexpr double kRounding = 1e-6;
  std::string halves;
  for (int c = 1; c < GrainClasses::kMost; ++c) {
    const double radius_m = GrainClasses::scale(c) * coarsest_m;
    if (std::abs(finest_m - radius_m) <= kRounding * radius_m) {
      return c + 1;
    }
    halves += fmt::format("{:g} m, ", radius_m);
  }
  throw InvalidParameter(
      "fine_radius_m", fmt::format("{:g}", finest_m),
      fmt::format("one of {}or 0: the soil's radius of {:g} m halved once, twice or three times", halves, coarsest_m));
}

bool GivenGrains::operator==(const GivenGrains& other) const {
  const bool same_grains =
      grains == other.grains || (count() == other.count() && count() > 0 && *grains == *other.grains);
  return held == other.held && (same_grains || count() + other.count() == 0);
}

SoilParameters finestSoil(const BedParameters& bed) {
  return rescaled(bed.soil, GrainClasses::scale(grainClasses(bed) - 1) * bed.soil.radius_m);
}

namespace {

void validateGrading(const BedParameters& bed) {
  const Grading& grading = bed.grading;
  requireInRange("fine_width_m", grading.fine_width_m, BedRanges::fine_length_m);
  requireInRange("fine_length_m", grading.fine_length_m, BedRanges::fine_length_m);
  requireInRange("fine_depth_m", grading.fine_depth_m, BedRanges::fine_length_m);
  requireInRange("fine_x_m", grading.fine_x_m, BedRanges::fine_place_m);
  requireInRange("fine_y_m", grading.fine_y_m, BedRanges::fine_place_m);
  if (grainClasses(bed) == 1) {
    return;
  }
  if (bed.soil.friction != FrictionModel::kContact) {
    throw InvalidParameter("fine_radius_m", fmt::format("{:g}", grading.fine_radius_m),
                           "0 with friction_model = \"icra2021\"; finer particles need friction_model = \"contact\"");
  }
  // A handful of the finest at least, and inside the box.
  const double narrowest_m = 4 * grading.fine_radius_m;
  const double beside_x_m = bed.periodic_x ? 0 : 2 * std::abs(grading.fine_x_m);
  const double beside_y_m = bed.periodic_y ? 0 : 2 * std::abs(grading.fine_y_m);
  requireInRange("fine_width_m", grading.fine_width_m, {narrowest_m, bed.width_m - beside_x_m});
  requireInRange("fine_length_m", grading.fine_length_m, {narrowest_m, bed.length_m - beside_y_m});
  requireInRange("fine_depth_m", grading.fine_depth_m, {narrowest_m, BedRanges::fine_length_m.highest});
}

}  // namespace

double shortestPeriod(const SoilParameters& soil) {
  return 3 * (makeContactLaw(soil).cutoff_m + (1 + 2 * soil.size_spread) * soil.radius_m);
}

namespace {

/// Two grains that are in one place, or so deep in each other that the middle of one is in the other: no soil is
/// pressed so hard, but a table that holds two moments of one bed, or the same grains twice, is full of them.
void refuseGrainsInEachOther(const BedParameters& bed) {
  const std::vector<std::array<float, 4>>& grains = *bed.given.grains;
  float highest_m = 0;
  float largest_m = 0;
  for (const auto& [x, y, z, excess] : grains) {
    highest_m = std::max(highest_m, z);
    largest_m = std::max(largest_m, excess);
  }
  const Periods periods = periodsOf(bed);
  const double radius_m = bed.soil.radius_m;
  CellGrid grid(grains.size(), 2 * (radius_m + static_cast<double>(largest_m)),
                {bed.width_m, bed.length_m, highest_m, periods});
  std::vector<std::int32_t> near(grid.candidatesAtMost());
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const auto& [x, y, z, excess] = grains[i];
    const std::uint32_t cell = grid.cellOf({x, y, z, excess});
    const std::uint32_t count = grid.candidates(cell, near.data());
    for (std::uint32_t k = 0; k < count; ++k) {
      const auto other = static_cast<std::size_t>(near[k]);
      const auto& [other_x, other_y, other_z, other_excess] = grains[other];
      Vec3 apart(x - other_x, y - other_y, z - other_z);
      apart.x() -= double{periods.width} * std::round(apart.x() * double{periods.per_width});
      apart.y() -= double{periods.length} * std::round(apart.y() * double{periods.per_length});
      const double larger_m = radius_m + std::max(double{excess}, double{other_excess});
      if (apart.squaredNorm() < larger_m * larger_m) {
        throw InvalidParameter(
            fmt::format("grains: numbers {} and {}", other + 1, i + 1),
            apart.norm() == 0 ? "at the same place" : fmt::format("{:.3g} m apart", apart.norm()),
            fmt::format("at least {:.3g} m apart, their radius; does the table contain a bed twice?", larger_m));
      }
    }
    grid.insert(static_cast<std::int32_t>(i), cell);
  }
}

/// One whose numbers cannot be, by its place in the list from 1.
void validateGiven(const BedParameters& bed) {
  const std::size_t count = bed.given.count();
  requireInRange("grains", static_cast<double>(count), BedRanges::particles);
  requireInRange("held", static_cast<double>(bed.given.held), {0, static_cast<double>(count) - 1});
  if (grainClasses(bed) > 1) {
    throw InvalidParameter("fine_radius_m", fmt::format("{:g}", bed.grading.fine_radius_m),
                           "0 in a bed of given grains");
  }
  constexpr double kRounding = 1e-6;
  const bool has_spread = bed.soil.friction == FrictionModel::kContact;
  const double spread_m = (has_spread ? bed.soil.size_spread : 0) * bed.soil.radius_m;
  const double most_excess_m = spread_m + kRounding * bed.soil.radius_m;
  const double beside_m = bed.given.held > 0 ? 4 * bed.soil.radius_m : 0;
  const auto fits = [](double value, double most) { return std::abs(value) <= most; };  // false for NaN
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [x, y, z, excess] = (*bed.given.grains)[i];
    if (!fits(x, bed.width_m / 2 + beside_m) || !fits(y, bed.length_m / 2 + beside_m) ||
        !(z >= 0 && z <= BedRanges::length_m.highest)) {
      throw InvalidParameter(fmt::format("grains: number {}", i + 1), fmt::format("({:g}, {:g}, {:g}) m", x, y, z),
                             fmt::format("in the box, {:g} m wide and {:g} m long around x = y = 0, and above its "
                                         "floor, z = 0",
                                         bed.width_m, bed.length_m));
    }
    if (!fits(excess, most_excess_m)) {
      throw InvalidParameter(fmt::format("grains: radius_m of number {}", i + 1),
                             fmt::format("{:g}", bed.soil.radius_m + excess),
                             fmt::format("{:g} to {:g}, as [soil] radius_mm and size_spread have it",
                                         bed.soil.radius_m - spread_m, bed.soil.radius_m + spread_m));
    }
  }
  refuseGrainsInEachOther(bed);
}

void validateStones(const BedParameters& bed) {
  validate(bed.stones);
  if (!bed.stones.any()) {
    return;
  }
  if (bed.soil.friction != FrictionModel::kContact) {
    throw InvalidParameter("stones", "with friction_model = \"icra2021\"", "in soil with friction_model = \"contact\"");
  }
  if (bed.periodic_x || bed.periodic_y) {
    throw InvalidParameter("stones", "in a periodic box", "in a box with walls");
  }
}

}  // namespace

void validate(const BedParameters& bed) {
  validate(bed.soil);
  requireInRange("stiffness_n_m", bed.soil.stiffness_n_m,
                 {});  // the analysis of layers may have it infinite, a bed not
  const ContactLaw law = makeContactLaw(bed.soil);
  requireHyperbola(law, 1e-5);  // in a tick, distances are floats
  const double diameter = 2 * bed.soil.radius_m;
  requireInRange("gravity_m_s2", bed.gravity_m_s2.norm(), BedRanges::gravity_m_s2);
  // With contact friction a particle remembers only the nearer of two walls, so it must never feel both.
  const double narrowest = bed.soil.friction == FrictionModel::kContact
                               ? law.cutoff_m + 2 * bed.soil.size_spread * bed.soil.radius_m
                               : diameter;
  requireInRange("width_m", bed.width_m, {narrowest, BedRanges::length_m.highest});
  requireInRange("length_m", bed.length_m, {narrowest, BedRanges::length_m.highest});
  requireInRange("wall_friction_ratio", bed.wall_friction_ratio, BedRanges::wall_friction_ratio);
  const double shortest_period = shortestPeriod(bed.soil);
  if (bed.periodic_x) {
    requireInRange("width_m", bed.width_m, {shortest_period, BedRanges::length_m.highest});
  }
  if (bed.periodic_y) {
    requireInRange("length_m", bed.length_m, {shortest_period, BedRanges::length_m.highest});
  }
  if (bed.start == BedStart::kPacked || bed.start == BedStart::kSettled) {
    requireInRange("depth_m", bed.depth_m, {diameter, BedRanges::length_m.highest});
  } else if (bed.start == BedStart::kGiven) {
    validateGiven(bed);
  } else {
    requireInRange("particles", bed.particles, BedRanges::particles);
  }
  if (bed.start == BedStart::kCount) {
    requireInRange("layers", bed.layers, BedRanges::layers);
  }
  if (bed.start == BedStart::kSettled) {  // nothing settles without weight
    requireInRange("gravity_m_s2", bed.gravity_m_s2.norm(), {0, BedRanges::gravity_m_s2.highest, Ends::kOpenBelow});
  }
  if (bed.start == BedStart::kRain || bed.start == BedStart::kSettled) {
    requireInRange("seed", static_cast<double>(bed.seed), BedRanges::seed);
  }
  validateGrading(bed);
  validateStones(bed);
  requireInRange("sleep_speed_m_s", bed.sleep_speed_m_s, BedRanges::sleep_speed_m_s);
  requireInRange("sleep_distance_m", bed.sleep_distance_m, BedRanges::sleep_distance_m);
  requireInRange("tick_s", bed.tick_s, BedRanges::tick_s);
  requireInRange("max_substeps", bed.max_substeps, BedRanges::max_substeps);
  requireInRange("threads", bed.threads, BedRanges::threads);
}

const BedParameters& validated(const BedParameters& bed) {
  validate(bed);
  return bed;
}

}  // namespace haptolith
