#include "haptolith/mesh/shown_surface.h"

#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace haptolith {

namespace {

using Triangle = std::array<std::int32_t, 3>;

std::size_t at(std::int32_t index) {
  return static_cast<std::size_t>(index);
}

/// Normals of all points: the area-weighted mean of the triangles around them.
std::vector<Vec3> normals(const TriangleMesh& mesh) {
  std::vector<Vec3> sums(mesh.points_m.size(), Vec3::Zero());
  for (const Triangle& t : mesh.triangles) {
    const auto [a, b, c] = cornersOf(mesh, t);
    const Vec3 normal = (b - a).cross(c - a);
    for (const std::int32_t i : t) {
      sums[at(i)] += normal;
    }
  }
  for (Vec3& sum : sums) {
    sum = sum.norm() > 0 ? Vec3(sum.normalized()) : Vec3(Vec3::Zero());
  }
  return sums;
}

TriangleMesh thickened(const TriangleMesh& sheet, double thickness_m) {
  const auto count = static_cast<std::int32_t>(sheet.points_m.size());
  const std::vector<Vec3> outward = normals(sheet);
  TriangleMesh closed;
  for (const double side : {0.5, -0.5}) {
    for (std::size_t i = 0; i < sheet.points_m.size(); ++i) {
      closed.points_m.emplace_back(sheet.points_m[i] + side * thickness_m * outward[i]);
    }
  }
  std::map<std::pair<std::int32_t, std::int32_t>, int> passed;  // number of passes of each edge in each direction
  for (const auto& [a, b, c] : sheet.triangles) {
    closed.triangles.push_back({a, b, c});
    closed.triangles.push_back({a + count, c + count, b + count});
    ++passed[{a, b}];
    ++passed[{b, c}];
    ++passed[{c, a}];
  }
  for (const auto& [edge, times] : passed) {
    const auto [a, b] = edge;
    if (times == 1 && !passed.contains({b, a})) {
      closed.triangles.push_back({b, a, a + count});
      closed.triangles.push_back({b, a + count, b + count});
    }
  }
  return closed;
}

/// Points within a cell of `edge_m` become one; triangles that lose their area go.
TriangleMesh clustered(const TriangleMesh& mesh, double edge_m) {
  std::map<std::array<std::int64_t, 3>, std::int32_t> cells;
  std::vector<std::int32_t> cluster_of(mesh.points_m.size());
  TriangleMesh coarse;
  std::vector<int> members;
  for (std::size_t i = 0; i < mesh.points_m.size(); ++i) {
    const Vec3 cell = (mesh.points_m[i] / edge_m).array().floor();
    const std::array<std::int64_t, 3> key{std::llround(cell.x()), std::llround(cell.y()), std::llround(cell.z())};
    const auto [found, is_new] = cells.try_emplace(key, static_cast<std::int32_t>(coarse.points_m.size()));
    if (is_new) {
      coarse.points_m.emplace_back(Vec3::Zero());
      members.push_back(0);
    }
    cluster_of[i] = found->second;
    coarse.points_m[at(found->second)] += mesh.points_m[i];
    ++members[at(found->second)];
  }
  for (std::size_t i = 0; i < members.size(); ++i) {
    coarse.points_m[i] /= members[i];
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    const Triangle t{cluster_of[at(a)], cluster_of[at(b)], cluster_of[at(c)]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) {
      coarse.triangles.push_back(t);
    }
  }
  return coarse;
}

}  // namespace

TriangleMesh shownSurface(const MendedMesh& mended, std::size_t most_triangles) {
  const double thickness_m = mended.sheet_thickness_m;
  const TriangleMesh whole = thickness_m > 0 ? thickened(mended.mesh, thickness_m) : mended.mesh;
  TriangleMesh shown = whole;
  constexpr double kCoarser = 1.3;
  for (double edge_m = cornersOf(whole).largestEdge() / 1000; shown.triangles.size() > most_triangles;
       edge_m *= kCoarser) {
    shown = clustered(whole, edge_m);
  }
  return shown;
}

}  // namespace haptolith
