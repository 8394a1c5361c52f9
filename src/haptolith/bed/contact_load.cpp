#include "haptolith/bed/contact_load.h"

#include <algorithm>
#include <cmath>

#include "haptolith/bed/cell_grid.h"
#include "haptolith/core/vec.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

std::vector<float> contactLoads(const BedParameters& bed, std::span<const Float4> positions) {
  const GrainClasses classes(bed.soil.radius_m, grainClasses(bed));
  struct Pair {
    ContactLaw law;
    double nearer_m;  ///< see ContactFrictionLaw
  };
  std::vector<Pair> pairs;
  for (int k = 0; k < classes.count() * classes.count(); ++k) {
    const SoilParameters soil = soilBetween(bed.soil, k / classes.count(), k % classes.count());
    pairs.push_back({makeContactLaw(soil), 2 * (bed.soil.radius_m - soil.radius_m)});
  }
  const ContactLaw& law = pairs.front().law;
  const double largest_excess_m = 2 * bed.soil.size_spread * bed.soil.radius_m;
  const Vec3 period_m(bed.periodic_x ? bed.width_m : 0, bed.periodic_y ? bed.length_m : 0, 0);
  double height_m = 0;
  for (const Float4& p : positions) {
    height_m = std::max(height_m, static_cast<double>(p.z));
  }
  CellGrid grid(positions.size(), law.diameter_m + largest_excess_m,
                {bed.width_m, bed.length_m, height_m, periodsOf(bed)});
  for (std::size_t i = 0; i < positions.size(); ++i) {
    grid.insert(static_cast<std::int32_t>(i), grid.cellOf(positions[i]));
  }
  std::vector<float> loads(positions.size());
  std::vector<std::int32_t> near(grid.candidatesAtMost());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Float4& p = positions[i];
    double load_n = 0;
    for (std::uint32_t k = 0, count = grid.candidates(grid.cellOf(p), near.data()); k < count; ++k) {
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
      const auto& [between, nearer_m] =
          pairs[static_cast<std::size_t>(classes.count() * classes.of(p.w) + classes.of(q.w))];
      const double a_m = apart_m.norm() - p.w - q.w - nearer_m;
      load_n += a_m < between.diameter_m ? contactForce(between, a_m) : 0;
    }
    loads[i] = static_cast<float>(load_n);
  }
  return loads;
}

}  // namespace haptolith
