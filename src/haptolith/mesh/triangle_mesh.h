#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "haptolith/core/vec.h"

namespace haptolith {

/// A surface of triangles, counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> points_m;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

/// Lowest and highest corner of the box around a mesh, mesh's frame, in m.
struct MeshCorners {
  Vec3 low_m = Vec3::Zero();
  Vec3 high_m = Vec3::Zero();

  [[nodiscard]] double largestEdge() const { return (high_m - low_m).maxCoeff(); }
};

/// Corners of the box around all points; zero without any. Not for the tick.
[[nodiscard]] inline MeshCorners cornersOf(const TriangleMesh& mesh) {
  MeshCorners corners;
  if (!mesh.points_m.empty()) {
    corners = {mesh.points_m.front(), mesh.points_m.front()};
  }
  for (const Vec3& point_m : mesh.points_m) {
    corners.low_m = corners.low_m.cwiseMin(point_m);
    corners.high_m = corners.high_m.cwiseMax(point_m);
  }
  return corners;
}

/// The three corners of a triangle, in m.
[[nodiscard]] inline std::array<Vec3, 3> cornersOf(const TriangleMesh& mesh, const std::array<std::int32_t, 3>& t) {
  return {mesh.points_m[static_cast<std::size_t>(t[0])], mesh.points_m[static_cast<std::size_t>(t[1])],
          mesh.points_m[static_cast<std::size_t>(t[2])]};
}

}  // namespace haptolith
