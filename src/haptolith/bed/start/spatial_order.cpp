#include "haptolith/bed/start/spatial_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "haptolith/core/math/portable_math.h"

namespace haptolith {

namespace {

/// Edges of a cell of 16 spheres in a close packing: four in a row, two rows, two layers; in diameters.
const Vec3 kCellDiameters(4, std::sqrt(3.0), 2 * std::sqrt(2.0 / 3));

struct Place {
  std::array<int, 3> cell;  // z, y, x
  std::size_t point;
};

}  // namespace

std::vector<std::size_t> spatialOrder(const std::vector<Vec3>& points_m, double radius_m) {
  if (points_m.empty()) {
    return {};
  }
  Vec3 lowest = points_m.front();
  Vec3 highest = lowest;
  for (const Vec3& point : points_m) {
    lowest = lowest.cwiseMin(point);
    highest = highest.cwiseMax(point);
  }
  const Vec3 edges = highest - lowest + Vec3::Constant(2 * radius_m);
  // Diameter in a close packing as loose as these points.
  const double diameter = portable::cbrt(std::sqrt(2.0) * edges.prod() / static_cast<double>(points_m.size()));
  lowest -= Vec3::Constant(diameter / 4);  // the lowest of a packing are well inside their cells
  std::vector<Place> places;
  places.reserve(points_m.size());
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const Vec3 cell = (points_m[i] - lowest).cwiseQuotient(diameter * kCellDiameters);
    places.push_back({{static_cast<int>(cell.z()), static_cast<int>(cell.y()), static_cast<int>(cell.x())}, i});
  }
  std::ranges::sort(places, [&](const Place& a, const Place& b) {
    const Vec3& p = points_m[a.point];
    const Vec3& q = points_m[b.point];
    return std::tie(a.cell, p.z(), p.y(), p.x(), a.point) < std::tie(b.cell, q.z(), q.y(), q.x(), b.point);
  });
  std::vector<std::size_t> order;
  order.reserve(points_m.size());
  for (const Place& place : places) {
    order.push_back(place.point);
  }
  return order;
}

std::vector<Vec3> inSpatialOrder(const std::vector<Vec3>& points_m, double radius_m) {
  std::vector<Vec3> ordered;
  ordered.reserve(points_m.size());
  for (const std::size_t point : spatialOrder(points_m, radius_m)) {
    ordered.push_back(points_m[point]);
  }
  return ordered;
}

std::vector<std::uint32_t> groupsInSlabs(const std::vector<Float4>& spheres, double radius_m) {
  const double slab_m = 2 * radius_m * kCellDiameters.y();
  std::vector<std::pair<std::int64_t, std::uint32_t>> places;  // slab, group
  for (std::size_t first = 0; first < spheres.size(); first += kGroup) {
    const std::size_t last = std::min(first + kGroup, spheres.size());
    double sum_m = 0;
    for (std::size_t i = first; i < last; ++i) {
      sum_m += spheres[i].y;
    }
    places.emplace_back(std::llround(sum_m / static_cast<double>(last - first) / slab_m),
                        static_cast<std::uint32_t>(first / kGroup));
  }
  std::ranges::sort(places);
  std::vector<std::uint32_t> order;
  order.reserve(places.size());
  for (const auto& [slab, group] : places) {
    order.push_back(group);
  }
  return order;
}

}  // namespace haptolith
