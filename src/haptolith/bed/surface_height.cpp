#include "haptolith/bed/surface_height.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace haptolith {

double meanSurfaceHeight(const Bed& bed) {
  const BedParameters& parameters = bed.parameters();
  const double radius_m = parameters.soil.radius_m;
  const double cell_m = radius_m / 2;
  const double width_m = parameters.width_m - 4 * radius_m;
  const double length_m = parameters.length_m - 4 * radius_m;
  const auto columns = std::max(1, static_cast<int>(width_m / cell_m));
  const auto rows = std::max(1, static_cast<int>(length_m / cell_m));
  std::vector<double> heights(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
  for (const Float4& grain : bed.state().position) {
    const double reach_m = radius_m + static_cast<double>(grain.w);
    const double x_m = static_cast<double>(grain.x) + width_m / 2;
    const double y_m = static_cast<double>(grain.y) + length_m / 2;
    const auto first = [&](double at_m) {
      return std::max(0, static_cast<int>(std::ceil((at_m - reach_m) / cell_m - 0.5)));
    };
    const auto last = [&](double at_m, int count) {
      return std::min(count - 1, static_cast<int>(std::floor((at_m + reach_m) / cell_m - 0.5)));
    };
    for (int row = first(y_m); row <= last(y_m, rows); ++row) {
      for (int column = first(x_m); column <= last(x_m, columns); ++column) {
        const double aside_m = std::hypot((column + 0.5) * cell_m - x_m, (row + 0.5) * cell_m - y_m);
        if (aside_m < reach_m) {
          double& height = heights[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                                   static_cast<std::size_t>(column)];
          height = std::max(height, static_cast<double>(grain.z) + std::sqrt(reach_m * reach_m - aside_m * aside_m));
        }
      }
    }
  }
  double sum = 0;
  for (const double height : heights) {
    sum += height;
  }
  return sum / static_cast<double>(heights.size());
}

}  // namespace haptolith
