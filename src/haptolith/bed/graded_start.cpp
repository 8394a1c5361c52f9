#include "haptolith/bed/graded_start.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "haptolith/bed/grain_classes.h"
#include "haptolith/bed/spatial_order.h"
#include "haptolith/core/error.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

namespace {

/// How thick the shell of a class is around finer ones, in its diameters: wide enough that grains four times as large
/// as others do not touch them.
constexpr double kShell = 2;

/// How deep a finer grain may stand in a coarser one where they are joined, in its radius; settling parts them.
constexpr double kMostOverlap = 0.3;

/// A box of grains of class c and finer, scene frame; it is open upwards.
struct Region {
  double low_x, high_x, low_y, high_y, floor;

  [[nodiscard]] bool holds(const Float4& grain) const {
    return grain.x > low_x && grain.x < high_x && grain.y > low_y && grain.y < high_y && grain.z > floor;
  }
  [[nodiscard]] Region grown(double by_m) const {
    return {low_x - by_m, high_x + by_m, low_y - by_m, high_y + by_m, floor - by_m};
  }
};

double radiusOf(const BedParameters& bed, int grain_class) {
  return GrainClasses::scale(grain_class) * bed.soil.radius_m;
}

/// Height of the soil: where columns as wide as a grain end, on average, and what lies over the centres of the topmost.
double surfaceOf(const std::vector<Float4>& grains, double radius_m) {
  constexpr double kAboveCentre = 0.6;
  std::map<std::pair<int, int>, float> top;
  for (const Float4& grain : grains) {
    const auto column = [radius_m](float place) { return static_cast<int>(std::floor(place / (2 * radius_m))); };
    float& highest = top.try_emplace({column(grain.x), column(grain.y)}, grain.z).first->second;
    highest = std::max(highest, grain.z);
  }
  double sum = 0;
  for (const auto& [column, highest] : top) {
    sum += highest;
  }
  return sum / static_cast<double>(top.size()) + kAboveCentre * radius_m;
}

/// Regions of classes 1 and finer, the largest first.
std::vector<Region> regionsOf(const BedParameters& bed, double surface_m) {
  const Grading& grading = bed.grading;
  Region region{grading.fine_x_m - grading.fine_width_m / 2, grading.fine_x_m + grading.fine_width_m / 2,
                grading.fine_y_m - grading.fine_length_m / 2, grading.fine_y_m + grading.fine_length_m / 2,
                surface_m - grading.fine_depth_m};
  std::vector<Region> regions{region};
  for (int c = grainClasses(bed) - 2; c > 0; --c) {
    region = region.grown(kShell * 2 * radiusOf(bed, c));
    regions.insert(regions.begin(), region);
  }
  return regions;
}

/// A bed of one class that fills a region up to the surface, to be cut: it repeats itself, and is deeper than what is
/// taken of it, for next to its floor grains lie in layers.
BedParameters tileFor(const BedParameters& bed, int grain_class, const Region& region, double surface_m) {
  constexpr double kDeeper = 6, kWider = 2;  // radii
  BedParameters tile = bed;
  tile.grading = {};
  tile.soil = rescaled(bed.soil, radiusOf(bed, grain_class));
  const double r = tile.soil.radius_m;
  const double shortest = 3 * (makeContactLaw(tile.soil).cutoff_m + (1 + 2 * tile.soil.size_spread) * r) + r;
  const auto side = [&](double low, double high, double most) {
    return std::max(std::min(high - low, most) + kWider * r, shortest);
  };
  tile.width_m = side(region.low_x, region.high_x, bed.width_m);
  tile.length_m = side(region.low_y, region.high_y, bed.length_m);
  tile.periodic_x = tile.periodic_y = true;
  tile.start = BedStart::kSettled;
  tile.seed = bed.seed + static_cast<std::uint64_t>(grain_class);
  tile.depth_m = surface_m - std::max(region.floor, 0.0) + kDeeper * r;
  return tile;
}

/// Whether a grain stands in a coarser one.
class Coarser {
 public:
  explicit Coarser(const BedParameters& bed) : radius_m_(bed.soil.radius_m), cell_m_(2.7 * bed.soil.radius_m) {}

  void add(const std::vector<Float4>& grains) {
    for (const Float4& grain : grains) {
      cells_[cellOf(grain, 0, 0, 0)].push_back(grain);
    }
  }

  [[nodiscard]] bool overlap(const Float4& grain) const {
    const double own = radius_m_ + grain.w;
    for (int k = 0; k < 27; ++k) {
      const auto found = cells_.find(cellOf(grain, k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
      if (found == cells_.end()) {
        continue;
      }
      for (const Float4& other : found->second) {
        const double apart = std::hypot(grain.x - other.x, grain.y - other.y, grain.z - other.z);
        if (apart < own + radius_m_ + other.w - kMostOverlap * own) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  using Cell = std::array<int, 3>;
  [[nodiscard]] Cell cellOf(const Float4& at, int dx, int dy, int dz) const {
    const auto index = [this](float place) { return static_cast<int>(std::floor(place / cell_m_)); };
    return {index(at.x) + dx, index(at.y) + dy, index(at.z) + dz};
  }

  double radius_m_, cell_m_;
  std::map<Cell, std::vector<Float4>> cells_;
};

/// Takes the highest away until whole groups are left.
void leaveWholeGroups(std::vector<Float4>& grains) {
  const std::size_t surplus = grains.size() % kGroup;
  std::ranges::stable_sort(grains, [](const Float4& a, const Float4& b) { return a.z < b.z; });
  grains.resize(grains.size() - surplus);
}

std::vector<Float4> ordered(const std::vector<Float4>& grains, double radius_m) {
  std::vector<Vec3> centres_m;
  centres_m.reserve(grains.size());
  for (const Float4& grain : grains) {
    centres_m.emplace_back(grain.x, grain.y, grain.z);
  }
  std::vector<Float4> ordered;
  for (const std::size_t i : spatialOrder(centres_m, radius_m)) {
    ordered.push_back(grains[i]);
  }
  return ordered;
}

}  // namespace

std::vector<Float4> gradedGrains(const BedParameters& bed, const std::vector<Float4>& coarse,
                                 const std::function<std::vector<Float4>(const BedParameters&)>& settled) {
  const int classes = grainClasses(bed);
  const double surface_m = surfaceOf(coarse, bed.soil.radius_m);
  const std::vector<Region> regions = regionsOf(bed, surface_m);
  const auto region_of = [&](int grain_class) -> const Region& {
    return regions[static_cast<std::size_t>(grain_class - 1)];
  };
  std::vector<Float4> all;
  Coarser coarser(bed);
  for (int c = 0; c < classes; ++c) {
    std::vector<Float4> own;
    const auto wanted = [&](const Float4& grain) {
      return (c == 0 || region_of(c).holds(grain)) && (c + 1 == classes || !region_of(c + 1).holds(grain));
    };
    if (c == 0) {
      std::ranges::copy_if(coarse, std::back_inserter(own), wanted);
    } else {
      const Region& region = region_of(c);
      const BedParameters tile = tileFor(bed, c, region, surface_m);
      const std::vector<Float4> made = settled(tile);
      // From the middle of the tile to that of the region, or of what is in the box of it; surface on surface.
      const auto middle = [](double low, double high, double side) {
        return (std::max(low, -side / 2) + std::min(high, side / 2)) / 2;
      };
      const double x = middle(region.low_x, region.high_x, bed.width_m);
      const double y = middle(region.low_y, region.high_y, bed.length_m);
      const double up = surface_m - surfaceOf(made, tile.soil.radius_m);
      for (Float4 grain : made) {
        // What has crossed an end of a tile that repeats itself has gone to the other end.
        grain.x = static_cast<float>(grain.x - tile.width_m * std::round(grain.x / tile.width_m) + x);
        grain.y = static_cast<float>(grain.y - tile.length_m * std::round(grain.y / tile.length_m) + y);
        grain.z = static_cast<float>(grain.z + up);
        grain.w = static_cast<float>(grain.w + tile.soil.radius_m - bed.soil.radius_m);
        const double radius_m = bed.soil.radius_m + grain.w;
        const bool inside = grain.z > radius_m && (bed.periodic_x || std::abs(grain.x) < bed.width_m / 2 - radius_m) &&
                            (bed.periodic_y || std::abs(grain.y) < bed.length_m / 2 - radius_m);
        if (inside && wanted(grain) && !coarser.overlap(grain)) {
          own.push_back(grain);
        }
      }
    }
    coarser.add(own);
    if (c + 1 < classes) {
      leaveWholeGroups(own);
    } else if (own.empty()) {
      throw InvalidParameter("fine_depth_m", fmt::format("{:g}", bed.grading.fine_depth_m),
                             "so much that grains fit into the fine soil");
    }
    const std::vector<Float4> in_order = ordered(own, radiusOf(bed, c));
    all.insert(all.end(), in_order.begin(), in_order.end());
  }
  return all;
}

}  // namespace haptolith
