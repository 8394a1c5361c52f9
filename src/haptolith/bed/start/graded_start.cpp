#include "haptolith/bed/start/graded_start.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>

#include "haptolith/bed/grain_classes.h"
#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/bed/start/spatial_order.h"
#include "haptolith/core/error.h"
#include "haptolith/core/math/portable_math.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

namespace {

/// Thickness of a class's shell around finer ones, in its diameters: wide enough that particles four times as large
/// as others do not touch them.
constexpr double kShell = 2;

/// Maximum overlap of joined particles, in the radius; settling separates them.
constexpr double kMostOverlap = 0.3;

std::vector<Float4> freeOf(const LyingSoil& soil) {
  return {soil.grains.begin(), soil.grains.end() - static_cast<std::ptrdiff_t>(soil.held)};
}

std::vector<Float4> heldOf(const LyingSoil& soil) {
  return {soil.grains.end() - static_cast<std::ptrdiff_t>(soil.held), soil.grains.end()};
}

/// Height of the soil as a camera sees it, whatever the size of its grains.
double surfaceOf(const std::vector<Float4>& grains, const BedParameters& bed) {
  return meanSurfaceHeight({.radius_m = bed.soil.radius_m, .grains = grains, .stones = {}}, bed);
}

/// Grains that have their place, to be asked whether there is room for another.
class StandingGrain {
 public:
  explicit StandingGrain(const BedParameters& bed) : radius_m_(bed.soil.radius_m), cell_m_(2.7 * bed.soil.radius_m) {}

  void add(const std::vector<Float4>& grains) {
    for (const Float4& grain : grains) {
      cells_[cellOf(grain, 0, 0, 0)].push_back(grain);
    }
  }

  [[nodiscard]] bool haveRoomFor(const Float4& grain) const {
    const double own = radius_m_ + grain.w;
    for (int k = 0; k < 27; ++k) {
      const auto found = cells_.find(cellOf(grain, k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
      if (found == cells_.end()) {
        continue;
      }
      for (const Float4& other : found->second) {
        const double apart = portable::hypot(grain.x - other.x, grain.y - other.y, grain.z - other.z);
        if (apart < own + radius_m_ + other.w - kMostOverlap * own) {
          return false;
        }
      }
    }
    return true;
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

double GradedFilling::Region::depthOf(const Float4& grain) const {
  return std::min(
      {grain.x - low_x, high_x - grain.x, grain.y - low_y, high_y - grain.y, static_cast<double>(grain.z) - floor});
}

double GradedFilling::radiusOf(int grain_class) const {
  return GrainClasses::scale(grain_class) * bed_.soil.radius_m;
}

GradedFilling::GradedFilling(const BedParameters& bed, const LyingSoil& coarse,
                             const std::function<std::vector<Float4>(const BedParameters&)>& settled)
    : bed_(bed),
      classes_(grainClasses(bed)),
      surface_m_(surfaceOf(coarse.grains, bed)),
      candidates_{freeOf(coarse)},
      held_(heldOf(coarse)) {
  const Grading& grading = bed.grading;
  Region region{grading.fine_x_m - grading.fine_width_m / 2, grading.fine_x_m + grading.fine_width_m / 2,
                grading.fine_y_m - grading.fine_length_m / 2, grading.fine_y_m + grading.fine_length_m / 2,
                surface_m_ - grading.fine_depth_m};
  regions_ = {region};
  for (int c = classes_ - 2; c > 0; --c) {
    region = region.grown(kShell * 2 * radiusOf(c));
    regions_.insert(regions_.begin(), region);
  }
  for (int c = 1; c < classes_; ++c) {
    const BedParameters tile = tileFor(c);
    candidates_.push_back(placed(settled(tile), tile, c));
  }
}

/// A bed of one class that fills a region up to the surface and the gaps next to it, to be cut: it repeats itself, and
/// is deeper than what is taken of it, for next to its floor grains lie in layers.
BedParameters GradedFilling::tileFor(int grain_class) const {
  constexpr double kDeeper = 6, kWider = 2;  // radii
  const Region region = regionOf(grain_class).grown(2 * radiusOf(grain_class - 1));
  BedParameters tile = bed_;
  tile.grading = {};
  tile.soil = rescaled(bed_.soil, radiusOf(grain_class));
  const double r = tile.soil.radius_m;
  const double shortest = 3 * (makeContactLaw(tile.soil).cutoff_m + (1 + 2 * tile.soil.size_spread) * r) + r;
  const auto side = [&](double low, double high, double most) {
    return std::max(std::min(high - low, most) + kWider * r, shortest);
  };
  tile.width_m = side(region.low_x, region.high_x, bed_.width_m);
  tile.length_m = side(region.low_y, region.high_y, bed_.length_m);
  tile.periodic_x = tile.periodic_y = true;
  tile.start = BedStart::kSettled;
  tile.ready_made = false;
  tile.seed = bed_.seed + static_cast<std::uint64_t>(grain_class);
  tile.depth_m = surface_m_ - std::max(region.floor, 0.0) + kDeeper * r;
  return tile;
}

/// Those grains of a tile that stand in the box: from the middle of the tile to that of the region, or of what is in
/// the box of it; surface on surface.
std::vector<Float4> GradedFilling::placed(std::vector<Float4> made, const BedParameters& tile, int grain_class) const {
  const Region region = regionOf(grain_class).grown(2 * radiusOf(grain_class - 1));
  const auto middle = [](double low, double high, double side) {
    return (std::max(low, -side / 2) + std::min(high, side / 2)) / 2;
  };
  const double x = middle(region.low_x, region.high_x, bed_.width_m);
  const double y = middle(region.low_y, region.high_y, bed_.length_m);
  const double up = surface_m_ - surfaceOf(made, tile);
  for (Float4& grain : made) {
    // A particle that has crossed an end of a periodic tile is at the other end.
    grain.x = static_cast<float>(grain.x - tile.width_m * std::round(grain.x / tile.width_m) + x);
    grain.y = static_cast<float>(grain.y - tile.length_m * std::round(grain.y / tile.length_m) + y);
    grain.z = static_cast<float>(grain.z + up);
    grain.w = static_cast<float>(grain.w + tile.soil.radius_m - bed_.soil.radius_m);
  }
  std::erase_if(made, [&](const Float4& grain) {
    const double radius_m = bed_.soil.radius_m + grain.w;
    return !(grain.z > radius_m && (bed_.periodic_x || std::abs(grain.x) < bed_.width_m / 2 - radius_m) &&
             (bed_.periodic_y || std::abs(grain.y) < bed_.length_m / 2 - radius_m));
  });
  return made;
}

bool GradedFilling::belongs(const Float4& grain, int grain_class, const std::vector<Float4>& left_out) const {
  if (grain_class + 1 < classes_ && regionOf(grain_class + 1).holds(grain)) {
    return false;
  }
  const auto in_place_of = [&](const Float4& coarser) {
    return portable::hypot(grain.x - coarser.x, grain.y - coarser.y, grain.z - coarser.z) <
           bed_.soil.radius_m + coarser.w;
  };
  return grain_class == 0 || regionOf(grain_class).grown(radiusOf(grain_class)).holds(grain) ||
         std::ranges::any_of(left_out, in_place_of);
}

LyingSoil GradedFilling::filledUp(const std::vector<Float4>& free) const {
  const GrainClasses classes(bed_.soil.radius_m, classes_);
  StandingGrain standing(bed_);
  standing.add(free);
  LyingSoil all;
  std::vector<Float4> left_out;  // from the class before, without a complete group: finer ones fill their place
  for (int c = 0; c < classes_; ++c) {
    std::vector<Float4> own;
    std::ranges::copy_if(candidates_[static_cast<std::size_t>(c)], std::back_inserter(own), [&](const Float4& grain) {
      return belongs(grain, c, left_out) && standing.haveRoomFor(grain);
    });
    const Region& finer = regionOf(std::min(c + 1, classes_ - 1));
    std::ranges::stable_sort(own, {}, [&](const Float4& grain) { return finer.depthOf(grain); });
    const auto whole = own.begin() + static_cast<std::ptrdiff_t>(own.size() / kGroup * kGroup);
    left_out.assign(whole, own.end());
    own.erase(whole, own.end());
    standing.add(own);
    if (c == 0) {
      standing.add(held_);  // no room for finer ones; the free coarse ones were always next to them
    }
    std::ranges::copy_if(free, std::back_inserter(own), [&](const Float4& grain) { return classes.of(grain.w) == c; });
    if (c + 1 == classes_ && own.empty()) {
      throw InvalidParameter("fine_depth_m", fmt::format("{:g}", bed_.grading.fine_depth_m),
                             "large enough that particles fit into the fine soil");
    }
    const std::vector<Float4> in_order = ordered(own, radiusOf(c));
    all.grains.insert(all.grains.end(), in_order.begin(), in_order.end());
  }
  all.grains.insert(all.grains.end(), held_.begin(), held_.end());
  all.held = held_.size();
  return all;
}

}  // namespace haptolith
