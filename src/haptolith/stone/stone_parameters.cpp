#include "haptolith/stone/stone_parameters.h"

#include <fmt/format.h>

#include <algorithm>

namespace haptolith {

namespace {

void validate(const PlacedStone& stone) {
  if (stone.form == StoneForm::kSpheres) {
    if (stone.spheres.empty() || stone.spheres.size() > kMostStoneSpheres) {
      throw InvalidParameter("spheres", fmt::format("{} spheres", stone.spheres.size()),
                             fmt::format("1 to {}", kMostStoneSpheres));
    }
    for (const StoneSphere& sphere : stone.spheres) {
      requireInRange("spheres", sphere.radius_m, kStoneSize_m);
      for (const double along_m : sphere.centre_m) {
        requireInRange("spheres", along_m, StonesRanges::sphere_place_m);
      }
    }
  } else {
    requireInRange("size_m", stone.size_m, kStoneSize_m);
  }
  requireInRange("seed", static_cast<double>(stone.seed), StonesRanges::seed);
  requireInRange("x_m", stone.x_m, StonesRanges::place_m);
  requireInRange("y_m", stone.y_m, StonesRanges::place_m);
  requireInRange("depth_m", stone.depth_m, StonesRanges::depth_m);
  for (const double turn_rad : stone.turn_rad) {
    requireInRange("turn_rad", turn_rad, StonesRanges::turn_rad);
  }
}

}  // namespace

double largestSphere(const StonesParameters& stones) noexcept {
  double largest_m = stones.count > 0 ? stones.largest_m / 2 : 0;  // the inner spheres are not larger than the stone
  for (const PlacedStone& stone : stones.placed) {
    largest_m = std::max(largest_m, stone.form == StoneForm::kSpheres ? 0 : stone.size_m / 2);
    for (const StoneSphere& sphere : stone.spheres) {
      largest_m = std::max(largest_m, sphere.radius_m);
    }
  }
  return largest_m;
}

void validate(const StonesParameters& stones) {
  requireInRange("count", stones.count, StonesRanges::count);
  requireInRange("smallest_m", stones.smallest_m, kStoneSize_m);
  requireInRange("largest_m", stones.largest_m, kStoneSize_m);
  requireInRange("exponent", stones.exponent, StonesRanges::exponent);
  requireInRange("shallowest_m", stones.shallowest_m, StonesRanges::depth_m);
  requireInRange("deepest_m", stones.deepest_m, StonesRanges::depth_m);
  if (stones.count > 0) {
    requireInRange("largest_m", stones.largest_m, {stones.smallest_m, kStoneSize_m.highest});
    requireInRange("deepest_m", stones.deepest_m, {stones.shallowest_m, StonesRanges::depth_m.highest});
  }
  requireInRange("seed", static_cast<double>(stones.seed), StonesRanges::seed);
  requireInRange("density_kg_m3", stones.density_kg_m3, StonesRanges::density_kg_m3);
  if (stones.form == StoneForm::kSpheres) {
    throw InvalidParameter("form", "spheres", "rock or sphere for stones at random places");
  }
  for (const PlacedStone& stone : stones.placed) {
    validate(stone);
  }
}

}  // namespace haptolith
