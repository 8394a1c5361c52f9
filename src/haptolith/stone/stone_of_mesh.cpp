#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "haptolith/core/process/stop_asked.h"
#include "haptolith/mesh/outer_surface.h"
#include "haptolith/mesh/triangle_tree.h"
#include "haptolith/stone/filling.h"
#include "haptolith/stone/stone_shape.h"

namespace haptolith {

namespace {

constexpr std::size_t kMeshPoints = 2000;
/// Of the size: how near the union has to come to the surface.
constexpr double kNearMesh = 1.0 / 50;
/// Spheres that fill less of a shape do not look like it.
constexpr double kLeastFilled = 0.5;

/// In m^3, by the divergence theorem, from a corner of the mesh.
double volumeOf(const TriangleMesh& mesh) {
  const Vec3 from_m = mesh.points_m.front();
  double sum_m3 = 0;
  for (const auto& triangle : mesh.triangles) {
    const auto [a, b, c] = cornersOf(mesh, triangle);
    sum_m3 += (a - from_m).dot((b - from_m).cross(c - from_m)) / 6;
  }
  return sum_m3;
}

}  // namespace

StoneShape stoneOfMesh(const MendedMesh& mesh, double size_m, std::size_t most_spheres) {
  requireInRange("size_m", size_m, kStoneSize_m);
  requireInRange("most_spheres", static_cast<double>(most_spheres), {1, static_cast<double>(kMostStoneSpheres)});
  if (mesh.sheet_thickness_m > 0) {
    throw InvalidParameter("mesh", fmt::format("a sheet of {} m", mesh.sheet_thickness_m), "a closed solid");
  }
  const double parts_m3 = mesh.mesh.triangles.empty() ? 0 : volumeOf(mesh.mesh);
  if (!(parts_m3 > 0)) {
    throw InvalidParameter("mesh", fmt::format("{} m^3", parts_m3), "a closed solid that looks outwards");
  }
  const TriangleTree tree(mesh.mesh);
  // Where parts pass through each other, spheres go on from one to the next.
  std::optional<TriangleMesh> outer;
  std::optional<TriangleTree> outer_tree;
  if (mesh.shell_count > 1) {
    outer = outerSurface(mesh, tree, std::cbrt(parts_m3) / 200, 1);
    throwIfStopped();
    outer_tree.emplace(*outer);
  }
  const TriangleMesh& surface = outer ? *outer : mesh.mesh;
  const TriangleTree& surface_tree = outer ? *outer_tree : tree;
  const double volume_m3 = volumeOf(surface);
  const double mesh_size_m = std::cbrt(6 * volume_m3 / std::numbers::pi);
  const DepthInSolid depth = [&](const Vec3& point_m, double most_m) {
    throwIfStopped();
    const TriangleTree::Nearest nearest = surface_tree.nearest(point_m, most_m);
    const double distance_m = nearest.place < 0 ? most_m : std::sqrt(nearest.squared_m2);
    return tree.winding(point_m, 0) > 0 ? distance_m : -distance_m;
  };
  std::vector<StoneSphere> spheres = fillWithSpheres(spreadOver(surface, kMeshPoints), depth,
                                                     {.size_m = mesh_size_m,
                                                      .near_m = kNearMesh * mesh_size_m,
                                                      .largest_radius_m = cornersOf(mesh.mesh).largestEdge() / 2,
                                                      .most_spheres = most_spheres});
  StoneShape stone;
  if (!spheres.empty()) {
    stone = makeStoneShape(std::move(spheres), mesh.mesh);
  }
  if (stone.volume_m3 < kLeastFilled * volume_m3) {
    throw InvalidParameter("mesh",
                           fmt::format("a solid of which {} spheres fill {:.0f} %", stone.spheres.size(),
                                       100 * stone.volume_m3 / volume_m3),
                           fmt::format("one piece, so thick that they fill {:.0f} % or more", 100 * kLeastFilled));
  }
  return scaledTo(std::move(stone), size_m);
}

}  // namespace haptolith
