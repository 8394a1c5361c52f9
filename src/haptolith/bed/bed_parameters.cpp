#include "haptolith/bed/bed_parameters.h"

#include "haptolith/core/error.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

double shortestPeriod(const SoilParameters& soil) {
  return 3 * (makeContactLaw(soil).cutoff_m + (1 + 2 * soil.size_spread) * soil.radius_m);
}

void validate(const BedParameters& bed) {
  validate(bed.soil);
  requireInRange("stiffness_n_m", bed.soil.stiffness_n_m,
                 {});  // the analysis of layers may have it infinite, a bed not
  const double diameter = 2 * bed.soil.radius_m;
  requireInRange("gravity_m_s2", bed.gravity_m_s2.norm(), BedRanges::gravity_m_s2);
  // With contact friction a particle remembers only the nearer of two walls, so it must never feel both.
  const double narrowest = bed.soil.friction == FrictionModel::kContact
                               ? makeContactLaw(bed.soil).cutoff_m + 2 * bed.soil.size_spread * bed.soil.radius_m
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
  requireInRange("sleep_speed_m_s", bed.sleep_speed_m_s, BedRanges::sleep_speed_m_s);
  requireInRange("tick_s", bed.tick_s, BedRanges::tick_s);
  requireInRange("max_substeps", bed.max_substeps, BedRanges::max_substeps);
  requireInRange("threads", bed.threads, BedRanges::threads);
}

}  // namespace haptolith
