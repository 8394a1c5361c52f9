#include "haptolith/lab/apparatus/heap_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

// Range of the height that counts as flank, as in tests of grain: straight on real heaps, clear of tip and foot.
constexpr double kFlankTop = 0.8;
constexpr double kFlankFoot = 0.2;

// Keeps the numbers of rings and patches in range; far beyond any heap.
constexpr double kMostRings = 1e6;

using Patch = std::pair<int, int>;  // ring and sector

Patch patchAt(double x, double y, double ring_width_m) {
  const int ring = int(std::hypot(x, y) / ring_width_m);
  const auto sectors = int(std::lround(2 * std::numbers::pi * (ring + 0.5)));
  const double turn = std::atan2(y, x) / (2 * std::numbers::pi) + 0.5;  // 0 to 1
  return {ring, std::min(int(turn * sectors), sectors - 1)};
}

std::vector<HeapRing> surfaceRings(std::span<const Vec3> centres_m, const HeapCase& heap, double ring_width_m) {
  std::map<Patch, HeapRing> highest;
  for (const Vec3& centre : centres_m) {
    const double x = requireInRange("particle's x_m", centre.x(), {}) - heap.axis_x_m;
    const double y = requireInRange("particle's y_m", centre.y(), {}) - heap.axis_y_m;
    const double distance = std::hypot(x, y);
    requireInRange("particle's distance from the heap's axis_m", distance, {0, kMostRings * ring_width_m});
    const HeapRing here{distance, requireInRange("particle's z_m", centre.z(), {}) + heap.radius_m - heap.floor_z_m};
    const auto [entry, is_first] = highest.try_emplace(patchAt(x, y, ring_width_m), here);
    if (!is_first && here.height_m > entry->second.height_m) {
      entry->second = here;
    }
  }

  std::map<int, std::pair<HeapRing, int>> sums;  // sums over the patches, and number of patches
  for (const auto& [patch, top] : highest) {
    auto& [sum, patches] = sums[patch.first];
    sum.radius_m += top.radius_m;
    sum.height_m += top.height_m;
    ++patches;
  }
  std::vector<HeapRing> rings;
  for (const auto& [ring, entry] : sums) {
    const auto& [sum, patches] = entry;
    rings.push_back({sum.radius_m / patches, sum.height_m / patches});
  }
  return rings;
}

/// Returns the rings outside the highest one between 80 % and 20 % of its height.
std::vector<HeapRing> flankOf(const std::vector<HeapRing>& rings) {
  const auto summit = std::ranges::max_element(rings, {}, &HeapRing::height_m);
  if (summit == rings.end()) {
    return {};
  }
  const auto below = [&](double part) {
    return [limit = part * summit->height_m](const HeapRing& ring) { return ring.height_m < limit; };
  };
  const auto top = std::find_if(summit, rings.end(), below(kFlankTop));
  const auto foot = std::find_if(top, rings.end(), below(kFlankFoot));
  return {top, foot};
}

}  // namespace

HeapProfile heapProfile(std::span<const Vec3> centres_m, const HeapCase& heap) {
  requireInRange("radius_m", heap.radius_m, {0, Range{}.highest, Ends::kOpen});
  requireInRange("axis_x_m", heap.axis_x_m, {});
  requireInRange("axis_y_m", heap.axis_y_m, {});
  requireInRange("floor_z_m", heap.floor_z_m, {});
  requireInRange("ring_width_m", heap.ring_width_m, {0, Range{}.highest});
  const double ring_width = heap.ring_width_m > 0 ? heap.ring_width_m : 4 * heap.radius_m;

  HeapProfile profile;
  profile.rings = surfaceRings(centres_m, heap, ring_width);
  profile.flank = flankOf(profile.rings);
  if (profile.flank.size() < 3) {
    throw Failure(
        fmt::format("the soil has no slope to measure: with {} particles, only {} rings of {:.4g} mm have their "
                    "surface between 20 % and 80 % of the height; 3 are needed. Cohesive soil can stand as a column: "
                    "use soil without cohesion (dry-sand), stronger gravity, or more soil",
                    centres_m.size(), profile.flank.size(), ring_width * 1000));
  }

  std::vector<double> distance;
  std::vector<double> height;
  for (const HeapRing& ring : profile.flank) {
    distance.push_back(ring.radius_m);
    height.push_back(ring.height_m);
  }
  profile.line = fitStraightLine(distance, height);
  profile.angle_of_repose_rad = std::atan(-profile.line.slope);
  profile.angle_se_rad = profile.line.slope_se / (1 + profile.line.slope * profile.line.slope);
  profile.height_m = std::ranges::max_element(profile.rings, {}, &HeapRing::height_m)->height_m;
  return profile;
}

}  // namespace haptolith
