#pragma once

// Meshes that tests make, in m, counter-clockwise seen from outside.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "haptolith/mesh/triangle_mesh.h"

namespace haptolith::made {

inline void addTriangle(TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto first = static_cast<std::int32_t>(mesh.points_m.size());
  mesh.points_m.insert(mesh.points_m.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

inline void addQuad(TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  addTriangle(mesh, a, b, c);
  addTriangle(mesh, a, c, d);
}

inline TriangleMesh box(const Vec3& low_m, const Vec3& high_m) {
  TriangleMesh mesh;
  const auto at = [&](int x, int y, int z) {
    return Vec3(x != 0 ? high_m.x() : low_m.x(), y != 0 ? high_m.y() : low_m.y(), z != 0 ? high_m.z() : low_m.z());
  };
  addQuad(mesh, at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0));
  addQuad(mesh, at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1));
  addQuad(mesh, at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1));
  addQuad(mesh, at(0, 1, 0), at(0, 1, 1), at(1, 1, 1), at(1, 1, 0));
  addQuad(mesh, at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0));
  addQuad(mesh, at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1));
  return mesh;
}

inline TriangleMesh cube(double edge_m, const Vec3& middle_m = Vec3::Zero()) {
  return box(middle_m - Vec3::Constant(edge_m / 2), middle_m + Vec3::Constant(edge_m / 2));
}

/// `across` quads from pole to pole and twice as many around.
inline TriangleMesh sphere(double radius_m, int across) {
  TriangleMesh mesh;
  const auto at = [&](int i, int j) -> Vec3 {
    const double polar = std::numbers::pi * i / across;
    const double around = std::numbers::pi * (j % (2 * across)) / across;
    const double out_m = i == 0 || i == across ? 0 : radius_m * std::sin(polar);
    return {out_m * std::cos(around), out_m * std::sin(around), radius_m * std::cos(polar)};
  };
  for (int i = 0; i < across; ++i) {
    for (int j = 0; j < 2 * across; ++j) {
      addTriangle(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      addTriangle(mesh, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return mesh;
}

/// Along z about the origin, of `sides` flat sides; open at its ends unless it has a wall.
inline TriangleMesh tube(double outer_m, double wall_m, double length_m, int sides) {
  TriangleMesh mesh;
  const auto at = [&](double radius_m, int j, int end) -> Vec3 {
    const double around = 2 * std::numbers::pi * (j % sides) / sides;
    return {radius_m * std::cos(around), radius_m * std::sin(around), (end - 0.5) * length_m};
  };
  const double inner_m = outer_m - wall_m;
  for (int j = 0; j < sides; ++j) {
    addQuad(mesh, at(outer_m, j, 0), at(outer_m, j + 1, 0), at(outer_m, j + 1, 1), at(outer_m, j, 1));
    if (wall_m > 0) {
      addQuad(mesh, at(inner_m, j, 0), at(inner_m, j, 1), at(inner_m, j + 1, 1), at(inner_m, j + 1, 0));
      addQuad(mesh, at(outer_m, j, 1), at(outer_m, j + 1, 1), at(inner_m, j + 1, 1), at(inner_m, j, 1));
      addQuad(mesh, at(outer_m, j, 0), at(inner_m, j, 0), at(inner_m, j + 1, 0), at(outer_m, j + 1, 0));
    }
  }
  return mesh;
}

inline TriangleMesh insideOut(TriangleMesh mesh) {
  for (auto& triangle : mesh.triangles) {
    std::swap(triangle[1], triangle[2]);
  }
  return mesh;
}

inline TriangleMesh together(TriangleMesh mesh, const TriangleMesh& other) {
  const auto first = static_cast<std::int32_t>(mesh.points_m.size());
  mesh.points_m.insert(mesh.points_m.end(), other.points_m.begin(), other.points_m.end());
  for (const auto& [a, b, c] : other.triangles) {
    mesh.triangles.push_back({first + a, first + b, first + c});
  }
  return mesh;
}

/// By the divergence theorem; > 0 when the triangles look outwards.
inline double volume_m3(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& triangle : mesh.triangles) {
    const auto [a, b, c] = cornersOf(mesh, triangle);
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

/// Signed distance to a box about the origin, from its definition.
inline double distanceToBox_m(const Vec3& point_m, const Vec3& half_m) {
  const Vec3 q = point_m.cwiseAbs() - half_m;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

}  // namespace haptolith::made
