#include "haptolith/bed/spatial_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace haptolith {

namespace {

constexpr int kBits = 20;  // of a coordinate

/// How far along the curve a cell is. In Skilling's algorithm the coordinates, as bits, are first turned as the curve
/// turns from the coarsest cube down, then Gray-decoded; taken in turns their bits are the number.
std::uint64_t alongCurve(std::array<std::uint32_t, 3> x) {
  for (std::uint32_t bit = 1U << (kBits - 1); bit > 1; bit >>= 1) {
    const std::uint32_t below = bit - 1;
    for (std::uint32_t& axis : x) {
      if ((axis & bit) != 0) {
        x[0] ^= below;
      } else {
        const std::uint32_t exchanged = (x[0] ^ axis) & below;
        x[0] ^= exchanged;
        axis ^= exchanged;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t flips = 0;
  for (std::uint32_t bit = 1U << (kBits - 1); bit > 1; bit >>= 1) {
    flips ^= (x[2] & bit) != 0 ? bit - 1 : 0;
  }
  std::uint64_t number = 0;
  for (int bit = kBits - 1; bit >= 0; --bit) {
    for (const std::uint32_t axis : x) {
      number = number << 1 | ((axis ^ flips) >> bit & 1);
    }
  }
  return number;
}

}  // namespace

std::vector<Vec3> inSpatialOrder(const std::vector<Vec3>& points_m, double cell_m) {
  if (points_m.empty()) {
    return {};
  }
  Vec3 lowest = points_m.front();
  for (const Vec3& point : points_m) {
    lowest = lowest.cwiseMin(point);
  }
  const auto cellOf = [&](double metres) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(metres / cell_m), 0.0, (1 << kBits) - 1.0));
  };
  struct Place {
    std::uint64_t number;
    std::size_t point;
  };
  std::vector<Place> places;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const Vec3 from_lowest = points_m[i] - lowest;
    places.push_back({alongCurve({cellOf(from_lowest.x()), cellOf(from_lowest.y()), cellOf(from_lowest.z())}), i});
  }
  std::ranges::sort(places, [](const Place& a, const Place& b) {
    return a.number < b.number || (a.number == b.number && a.point < b.point);
  });
  std::vector<Vec3> ordered;
  for (const Place& place : places) {
    ordered.push_back(points_m[place.point]);
  }
  return ordered;
}

}  // namespace haptolith
