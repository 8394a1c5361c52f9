#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "haptolith/mesh/triangle_mesh.h"

namespace haptolith {

/// Square of the distance from a point to a triangle, in m^2; also of one that is a line or a point.
[[nodiscard]] double squaredDistance(const Vec3& point_m, const std::array<Vec3, 3>& triangle_m) noexcept;

/// Spatial index of a mesh: a tree of boxes, made once. Not for the tick.
class TriangleTree {
 public:
  /// @param threads  at least 1; any number makes the same tree.
  explicit TriangleTree(const TriangleMesh& mesh, int threads = 1);

  struct Nearest {
    double squared_m2 = std::numeric_limits<double>::infinity();
    std::int32_t place = -1;  ///< index of the triangle in the tree, for `hint`; -1 when none is near enough
  };
  /// The nearest triangle to a point, where one is nearer than `most_m`.
  /// @param hint  place of a triangle that is probably near; -1 for none.
  [[nodiscard]] Nearest nearest(const Vec3& point_m, double most_m, std::int32_t hint = -1) const noexcept;

  /// A triangle near a point.
  struct Near {
    double distance_m = 0;
    std::int32_t place = 0;  ///< in the tree
  };
  /// All triangles nearer to a point than `most_m`, the nearest first; false when there are more than `most`.
  [[nodiscard]] bool within(const Vec3& point_m, double most_m, std::size_t most, std::vector<Near>& found) const;

  /// The nearest of some triangles to a point; none further away than `most_m`.
  /// @param near       nearest first to a point `away_m` from this one, and all that may be the nearest to this one.
  [[nodiscard]] double squaredDistanceTo(const Vec3& point_m, double most_m, std::span<const Near> near,
                                         double away_m) const noexcept;

  /// A surface that a straight line along an axis passes.
  struct Crossing {
    double at_m = 0;            ///< coordinate along the axis
    int step = 0;               ///< +1 where a line in the axis' direction goes in, -1 where it goes out
    std::int32_t triangle = 0;  ///< index in the mesh
  };
  /// All crossings of the line through `point_m` along axis 0, 1 or 2 that lie beyond the point (`forward`) or before
  /// it, in no order. A line through an edge or a corner of a closed surface passes each sheet of it once: both
  /// triangles of an edge compute the same side, and a tie goes to one of them.
  void crossings(const Vec3& point_m, int axis, bool forward, std::vector<Crossing>& found) const;

  /// Winding number of a closed surface about a point: > 0 inside.
  /// @param axis  of the ray; one that crosses the surfaces near the point at large angles is the most reliable.
  [[nodiscard]] int winding(const Vec3& point_m, int axis) const;

  /// A triangle of the mesh that a ray meets, and how far away.
  struct Hit {
    double distance_m = 0;
    std::int32_t triangle = 0;
  };
  /// All triangles that a ray meets, in no order; an edge or a corner may be met once, twice or never.
  void hits(const Vec3& from_m, const Vec3& unit_direction, std::vector<Hit>& found) const;

  /// Whether the box of any triangle for which `counts` holds meets this box.
  template <class Counts>
  [[nodiscard]] bool anyInBox(const Vec3& low_m, const Vec3& high_m, const Counts& counts) const {
    bool found = false;
    forEachNear(
        [&](const Node& node, int i) { return !found && meets(node, i, low_m - middle_m_, high_m - middle_m_); },
        [&](std::int32_t place) {
          const std::array<Vec3, 3>& t = corners_m_[static_cast<std::size_t>(place)];
          const Vec3 low = t[0].cwiseMin(t[1]).cwiseMin(t[2]);
          const Vec3 high = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
          found = found || ((low.array() <= high_m.array()).all() && (high.array() >= low_m.array()).all() &&
                            counts(triangles_[static_cast<std::size_t>(place)]));
        });
    return found;
  }

 private:
  static constexpr int kBranches = 4;
  static constexpr std::size_t kDeepest = 64;
  /// Four boxes around triangles, rounded outwards, and discs: most surfaces are flat and askew where one looks
  /// closely, and a box around a piece of them reaches far from it. From the tree's middle; all four at a time.
  struct Node {
    using Four = Eigen::Array<float, kBranches, 1>;
    std::array<Four, 3> low_m, high_m;
    std::array<Four, 3> disc_m, normal;
    Four half_thickness_m, radius_m;
    std::array<std::int32_t, std::size_t{kBranches}> branch;  ///< a node; ~place of a triangle; 0: nothing
  };

  static bool meets(const Node& node, int i, const Vec3& low_m, const Vec3& high_m) noexcept {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (node.low_m[axis][i] > high_m[static_cast<Eigen::Index>(axis)] ||
          node.high_m[axis][i] < low_m[static_cast<Eigen::Index>(axis)]) {
        return false;
      }
    }
    return true;
  }

  /// Calls work(place) for the triangles in boxes that `enters(node, branch)`.
  template <class Enters, class Work>
  void forEachNear(const Enters& enters, const Work& work) const {
    std::array<std::int32_t, kDeepest> waiting{};
    std::size_t depth = 1;
    while (depth > 0) {
      const Node& node = nodes_[static_cast<std::size_t>(waiting[--depth])];
      for (int i = 0; i < kBranches; ++i) {
        if (node.branch[static_cast<std::size_t>(i)] == 0 || !enters(node, i)) {
          continue;
        }
        if (node.branch[static_cast<std::size_t>(i)] < 0) {
          work(~node.branch[static_cast<std::size_t>(i)]);
        } else {
          waiting[depth++] = node.branch[static_cast<std::size_t>(i)];
        }
      }
    }
  }

  struct Item;
  static std::array<std::size_t, kBranches> shares(std::size_t n) noexcept;
  static std::size_t nodesFor(std::size_t n) noexcept;
  static std::size_t split(std::span<Item> items);
  void build(std::span<Item> items, std::size_t index, std::size_t first, int threads);
  void describe(std::span<const Item> items, Node& node, int i) const;

  std::vector<Node> nodes_;
  std::vector<std::array<Vec3, 3>> corners_m_;  // in the order of the leaves
  std::vector<std::int32_t> triangles_;         // of the mesh, in this order
  Vec3 middle_m_ = Vec3::Zero();
  double half_diagonal_m_ = 0;
  const TriangleMesh* mesh_ = nullptr;  // while it is made
};

}  // namespace haptolith
