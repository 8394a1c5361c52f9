#include "haptolith/mesh/mesh_edges.h"

#include <algorithm>
#include <tuple>

namespace haptolith {

std::vector<Edge> edgesOf(const TriangleMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::int32_t from = mesh.triangles[i][corner];
      const std::int32_t to = mesh.triangles[i][(corner + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), static_cast<std::int32_t>(i), from < to});
    }
  }
  std::ranges::sort(edges, [](const Edge& a, const Edge& b) {
    return std::tuple(a.low, a.high, a.triangle) < std::tuple(b.low, b.high, b.triangle);
  });
  return edges;
}

int imbalance(std::span<const Edge> same) {
  int sum = 0;
  for (const Edge& edge : same) {
    sum += edge.forward ? 1 : -1;
  }
  return sum;
}

}  // namespace haptolith
