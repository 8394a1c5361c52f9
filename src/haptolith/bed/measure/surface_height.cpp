#include "haptolith/bed/measure/surface_height.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "haptolith/core/math/portable_math.h"
#include "haptolith/core/statistics.h"

namespace haptolith {

namespace {

/// Raises a field of rays to a sphere.
void raise(const Float4& sphere, double radius_m, const HeightGrid& rays, std::vector<double>& heights) {
  const double reach_m = radius_m + static_cast<double>(sphere.w);
  const double x_m = static_cast<double>(sphere.x) - rays.x_m;
  const double y_m = static_cast<double>(sphere.y) - rays.y_m;
  const auto first = [&](double at_m) {
    return std::max<std::int64_t>(0, static_cast<std::int64_t>(std::ceil((at_m - reach_m) / rays.cell_m - 0.5)));
  };
  const auto last = [&](double at_m, std::size_t count) {
    return std::min(static_cast<std::int64_t>(count) - 1,
                    static_cast<std::int64_t>(std::floor((at_m + reach_m) / rays.cell_m - 0.5)));
  };
  for (std::int64_t row = first(y_m); row <= last(y_m, rays.rows); ++row) {
    for (std::int64_t column = first(x_m); column <= last(x_m, rays.columns); ++column) {
      const double aside_m = portable::hypot((static_cast<double>(column) + 0.5) * rays.cell_m - x_m,
                                             (static_cast<double>(row) + 0.5) * rays.cell_m - y_m);
      if (aside_m < reach_m) {
        double& height = heights[static_cast<std::size_t>(row) * rays.columns + static_cast<std::size_t>(column)];
        height = std::max(height, static_cast<double>(sphere.z) + std::sqrt(reach_m * reach_m - aside_m * aside_m));
      }
    }
  }
}

}  // namespace

HeightGrid gridWithinSides(const BedParameters& bed, double cell_m) {
  const double width_m = bed.width_m - 4 * bed.soil.radius_m;
  const double length_m = bed.length_m - 4 * bed.soil.radius_m;
  const auto fit = [&](double side_m) { return static_cast<std::size_t>(std::max(1.0, side_m / cell_m)); };
  return {-width_m / 2, -length_m / 2, cell_m, fit(width_m), fit(length_m)};
}

SeenSoil seenSoil(const Bed& bed) {
  SeenSoil seen;
  seen.radius_m = bed.parameters().soil.radius_m;
  const BedState& state = bed.state();
  seen.grains.assign(state.position.begin(), state.position.begin() + static_cast<std::ptrdiff_t>(state.particles()));
  const Stones& stones = bed.stones();
  for (std::size_t stone = 0; stone < stones.size(); ++stone) {
    for (std::size_t i = 0; i < stones.spheres(stone).size(); ++i) {
      const Vec3& at_m = stones.spheres(stone)[i];
      seen.stones.push_back({static_cast<float>(at_m.x()), static_cast<float>(at_m.y()), static_cast<float>(at_m.z()),
                             static_cast<float>(stones.shape(stone)->spheres[i].radius_m - seen.radius_m)});
    }
  }
  return seen;
}

SeenSoil seenSoil(const Bed& bed, double radius_m, std::span<const Float4> grains, std::span<const Pose> stones) {
  SeenSoil seen;
  seen.radius_m = radius_m;
  seen.grains.assign(grains.begin(), grains.end());
  for (std::size_t stone = 0; stone < std::min(stones.size(), bed.stones().size()); ++stone) {
    for (const StoneSphere& sphere : bed.stones().shape(stone)->spheres) {
      const Vec3 at_m = stones[stone].fromBody(sphere.centre_m);
      seen.stones.push_back({static_cast<float>(at_m.x()), static_cast<float>(at_m.y()), static_cast<float>(at_m.z()),
                             static_cast<float>(sphere.radius_m - seen.radius_m)});
    }
  }
  return seen;
}

std::vector<double> surfaceHeights(const SeenSoil& seen, const HeightGrid& grid, std::size_t rays) {
  const HeightGrid fine{grid.x_m, grid.y_m, grid.cell_m / static_cast<double>(rays), grid.columns * rays,
                        grid.rows * rays};
  std::vector<double> rayed(fine.cells(), 0);
  for (const std::vector<Float4>* spheres : {&seen.grains, &seen.stones}) {
    for (const Float4& sphere : *spheres) {
      raise(sphere, seen.radius_m, fine, rayed);
    }
  }
  if (rays == 1) {
    return rayed;
  }
  std::vector<double> heights(grid.cells(), 0);
  for (std::size_t i = 0; i < rayed.size(); ++i) {
    heights[i / fine.columns / rays * grid.columns + i % fine.columns / rays] += rayed[i];
  }
  for (double& height : heights) {
    height /= static_cast<double>(rays * rays);
  }
  return heights;
}

double meanSurfaceHeight(const Bed& bed) {
  return meanSurfaceHeight(seenSoil(bed), bed.parameters());
}

double meanSurfaceHeight(SeenSoil seen, const BedParameters& bed) {
  seen.stones.clear();
  return mean(surfaceHeights(seen, gridWithinSides(bed, seen.radius_m / 2), 1));
}

}  // namespace haptolith
