#include "haptolith/bed/measure/contact_load.h"

#include <algorithm>
#include <cmath>

#include "haptolith/bed/cell_grid.h"
#include "haptolith/bed/grain_classes.h"
#include "haptolith/bed/kernel/kernel_law.h"
#include "haptolith/core/vec.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

namespace {

/// Force between two sizes of grain, at a distance that is given as if both were of the soil's own size.
struct PairLaw {
  ContactLaw law;
  double nearer_m;  ///< 2 (R - the radius between the two): see ContactFrictionLaw
};

}  // namespace

std::vector<float> contactLoads(const BedParameters& bed, std::span<const Float4> positions) {
  const GrainClasses classes(bed.soil.radius_m, grainClasses(bed));
  const auto count = static_cast<std::size_t>(classes.count());
  const double reach_m = 2 * bed.soil.radius_m * (1 + bed.soil.size_spread);
  const Vec3 period_m(bed.periodic_x ? bed.width_m : 0, bed.periodic_y ? bed.length_m : 0, 0);
  double height_m = 0;
  for (const Float4& p : positions) {
    height_m = std::max(height_m, static_cast<double>(p.z));
  }
  // A grid for each size, its cells as wide as two of them; a grain looks for those of its size and for larger ones.
  std::vector<CellGrid> grids;
  std::vector<PairLaw> laws;
  for (int c = 0; c < classes.count(); ++c) {
    grids.emplace_back(positions.size(), GrainClasses::scale(c) * reach_m,
                       GridBox{bed.width_m, bed.length_m, height_m, periodsOf(bed)});
    for (int d = 0; d < classes.count(); ++d) {
      const SoilParameters between = soilBetween(bed.soil, c, d);
      laws.push_back({makeContactLaw(between), 2 * (bed.soil.radius_m - between.radius_m)});
    }
  }
  const auto class_of = [&](const Float4& p) { return static_cast<std::size_t>(classes.of(p.w)); };
  for (std::size_t i = 0; i < positions.size(); ++i) {
    CellGrid& grid = grids[class_of(positions[i])];
    grid.insert(static_cast<std::int32_t>(i), grid.cellOf(positions[i]));
  }
  std::vector<double> loads_n(positions.size());
  std::vector<std::int32_t> near(grids.front().candidatesAtMost());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Float4& p = positions[i];
    const std::size_t own = class_of(p);
    for (std::size_t other = 0; other <= own; ++other) {
      const auto& [law, nearer_m] = laws[own * count + other];
      const CellGrid& grid = grids[other];
      for (std::uint32_t k = 0, found = grid.candidates(grid.cellOf(p), near.data()); k < found; ++k) {
        const auto j = static_cast<std::size_t>(near[k]);
        if (j == i) {
          continue;
        }
        const Float4& q = positions[j];
        Vec3 apart_m(p.x - q.x, p.y - q.y, p.z - q.z);
        for (int axis = 0; axis < 2; ++axis) {
          if (period_m[axis] > 0) {
            apart_m[axis] -= period_m[axis] * std::round(apart_m[axis] / period_m[axis]);
          }
        }
        const double a_m = apart_m.norm() - p.w - q.w - nearer_m;
        const double push_n = a_m < law.diameter_m ? contactForce(law, a_m) : 0;
        loads_n[i] += push_n;
        loads_n[j] += other < own ? push_n : 0;  // which will not look for smaller ones
      }
    }
  }
  return {loads_n.begin(), loads_n.end()};
}

}  // namespace haptolith
