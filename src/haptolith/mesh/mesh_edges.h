#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "haptolith/mesh/triangle_mesh.h"

namespace haptolith {

using Triangle = std::array<std::int32_t, 3>;

inline std::size_t indexOf(std::int32_t index) {
  return static_cast<std::size_t>(index);
}

/// Disjoint sets of indices (union-find with path halving); the least index represents its set.
class UnionFind {
 public:
  explicit UnionFind(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::int32_t find(std::int32_t i) {
    while (parent_[indexOf(i)] != i) {
      parent_[indexOf(i)] = parent_[indexOf(parent_[indexOf(i)])];
      i = parent_[indexOf(i)];
    }
    return i;
  }
  void unite(std::int32_t a, std::int32_t b) {
    a = find(a);
    b = find(b);
    parent_[indexOf(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<std::int32_t> parent_;
};

/// A triangle's edge: its ends in order, and whether the triangle passes it from the lower to the higher.
struct Edge {
  std::int32_t low, high;
  std::int32_t triangle;
  bool forward;

  [[nodiscard]] auto ends() const { return std::pair(low, high); }
};

/// All edges of a mesh, those between the same points next to each other.
[[nodiscard]] std::vector<Edge> edgesOf(const TriangleMesh& mesh);

/// Calls work(span of the edges between two points) for each such pair.
template <class Work>
void forEachEdge(std::span<const Edge> edges, const Work& work) {
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].ends() == edges[i].ends()) {
      ++end;
    }
    work(edges.subspan(i, end - i));
    i = end;
  }
}

/// Forward passes of an edge less its backward passes: 0 where the surface is closed.
[[nodiscard]] int imbalance(std::span<const Edge> same);

}  // namespace haptolith
