#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "haptolith/core/vec.h"

namespace haptolith {

/// Cuts the polygons of one file into triangles.
///
/// Triangles keep the polygon's order of corners, and all of its edges. A polygon without dents becomes a fan about its
/// first corner. One with dents is cut by clipping ears (Meisters 1975), seen along its mean normal (Newell), so that
/// the triangles cover what the polygon covers: a fan would also cover its dents. Corners need not lie in one plane.
class PolygonCutter {
 public:
  /// @param corners  at least 3, in any unit, finite.
  /// @param triangles  numbers of corners; replaced.
  /// @return false when polygons with dents took more comparisons than a few seconds are long, in all calls together.
  [[nodiscard]] bool cut(std::span<const Vec3> corners, std::vector<std::array<std::size_t, 3>>& triangles);

 private:
  static constexpr std::int64_t kMostComparisons = 200'000'000;
  std::int64_t left_ = kMostComparisons;
};

}  // namespace haptolith
