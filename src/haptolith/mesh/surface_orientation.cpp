#include "haptolith/mesh/surface_orientation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/stop_asked.h"
#include "haptolith/mesh/mesh_edges.h"
#include "haptolith/mesh/triangle_tree.h"

namespace haptolith {

Patches turnNeighbours(TriangleMesh& mesh) {
  const std::size_t n = mesh.triangles.size();
  struct Neighbour {
    std::int32_t triangle = -1;
    bool opposed = false;  ///< looks the other way
  };
  std::vector<std::array<Neighbour, 3>> neighbours(n);
  std::vector<std::uint8_t> count(n);
  forEachEdge(edgesOf(mesh), [&](std::span<const Edge> same) {
    if (same.size() == 2 && same[0].triangle != same[1].triangle) {
      const bool opposed = same[0].forward == same[1].forward;
      for (std::size_t side = 0; side < 2; ++side) {
        const std::size_t own = indexOf(same[side].triangle);
        neighbours[own][count[own]++] = {same[1 - side].triangle, opposed};
      }
    }
  });
  Patches patches{.of = std::vector<std::int32_t>(n, -1), .as_in_file = {}};
  std::vector<bool> turned(n);
  std::vector<std::int32_t> members;
  for (std::size_t seed = 0; seed < n; ++seed) {
    if (patches.of[seed] >= 0) {
      continue;
    }
    const auto patch = static_cast<std::int32_t>(patches.as_in_file.size());
    members.assign(1, static_cast<std::int32_t>(seed));
    patches.of[seed] = patch;
    std::size_t opposed = 0;
    for (std::size_t i = 0; i < members.size(); ++i) {
      const std::size_t own = indexOf(members[i]);
      for (std::size_t k = 0; k < count[own]; ++k) {
        const std::size_t other = indexOf(neighbours[own][k].triangle);
        const bool turn = turned[own] != neighbours[own][k].opposed;
        if (patches.of[other] < 0) {
          patches.of[other] = patch;
          turned[other] = turn;
          opposed += turn ? 1 : 0;
          members.push_back(static_cast<std::int32_t>(other));
        } else if (turned[other] != turn) {
          patches.one_sided = true;
        }
      }
    }
    const bool by_seed = 2 * opposed <= members.size();  // as most look
    for (const std::int32_t member : members) {
      turned[indexOf(member)] = turned[indexOf(member)] == by_seed;
    }
    const std::size_t changed = by_seed ? opposed : members.size() - opposed;
    patches.turned += changed;
    patches.as_in_file.push_back(changed == 0);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (turned[i]) {
      std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
    }
  }
  return patches;
}

Shells shellsOf(const TriangleMesh& mesh, const Patches& patches) {
  const std::size_t n = patches.as_in_file.size();
  std::vector<Edge> edges = edgesOf(mesh);
  // A patch that is closed alone passes each of its edges as often forward as backward.
  std::vector<bool> closed_alone(n, true);
  Shells shells;
  std::vector<std::pair<std::int32_t, int>> sums;
  const auto sums_of = [&](std::span<const Edge> same) -> std::span<const std::pair<std::int32_t, int>> {
    sums.clear();
    for (const Edge& edge : same) {
      sums.emplace_back(patches.of[indexOf(edge.triangle)], edge.forward ? 1 : -1);
    }
    std::ranges::sort(sums);
    std::size_t kept = 0;
    for (std::size_t i = 1; i < sums.size(); ++i) {
      if (sums[i].first == sums[kept].first) {
        sums[kept].second += sums[i].second;
      } else {
        sums[++kept] = sums[i];
      }
    }
    return std::span(sums).first(kept + 1);
  };
  forEachEdge(edges, [&](std::span<const Edge> same) {
    for (const auto& [patch, sum] : sums_of(same)) {
      closed_alone[indexOf(patch)] = closed_alone[indexOf(patch)] && sum == 0;
    }
    shells.closed = shells.closed && imbalance(same) == 0;
  });
  UnionFind together(n);
  forEachEdge(edges, [&](std::span<const Edge> same) {
    std::int32_t last = -1;
    for (const Edge& edge : same) {
      const std::int32_t patch = patches.of[indexOf(edge.triangle)];
      if (!closed_alone[indexOf(patch)]) {
        if (last >= 0) {
          together.unite(last, patch);
        }
        last = patch;
      }
    }
  });
  std::vector<std::int32_t> number(n, -1);
  for (std::size_t patch = 0; patch < n; ++patch) {
    const std::size_t root = indexOf(together.find(static_cast<std::int32_t>(patch)));
    if (number[root] < 0) {
      number[root] = static_cast<std::int32_t>(shells.as_in_file.size());
      shells.as_in_file.push_back(true);
    }
    number[patch] = number[root];
    shells.as_in_file[indexOf(number[patch])] = shells.as_in_file[indexOf(number[patch])] && patches.as_in_file[patch];
  }
  for (const std::int32_t patch : patches.of) {
    shells.of.push_back(number[indexOf(patch)]);
  }
  return shells;
}

Turned turnOutwards(TriangleMesh& mesh, const Shells& shells) {
  const std::size_t n = shells.as_in_file.size();
  struct Shell {
    double volume_m3 = 0;  ///< negative when it looks inwards
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = -low;
    std::vector<std::int32_t> some;  ///< sample triangles that locate it
    std::int32_t around = -1;        ///< the smallest shell that holds it
    int side = 0;                    ///< +1 looks outwards in the end, -1 is a cavity; 0: not yet known
  };
  std::vector<Shell> all(n);
  std::vector<std::size_t> size(n);
  for (const std::int32_t shell : shells.of) {
    ++size[indexOf(shell)];
  }
  std::vector<std::size_t> passed(n);
  const Vec3 origin = mesh.points_m[indexOf(mesh.triangles[0][0])];
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Shell& shell = all[indexOf(shells.of[i])];
    const auto [a, b, c] = cornersOf(mesh, mesh.triangles[i]);
    shell.volume_m3 += (a - origin).dot((b - origin).cross(c - origin)) / 6;
    for (const Vec3& corner : {a, b, c}) {
      shell.low = shell.low.cwiseMin(corner);
      shell.high = shell.high.cwiseMax(corner);
    }
    constexpr std::size_t kSome = 5;
    if (passed[indexOf(shells.of[i])]++ % std::max<std::size_t>(1, size[indexOf(shells.of[i])] / kSome) == 0) {
      shell.some.push_back(static_cast<std::int32_t>(i));
    }
  }
  if (n > 1) {
    const TriangleTree tree(mesh, 2);
    std::vector<TriangleTree::Crossing> crossings;
    std::vector<int> windings(n);
    for (std::size_t own = 0; own < n; ++own) {
      std::vector<std::size_t> holders(n);
      for (const std::int32_t triangle : all[own].some) {
        const auto [a, b, c] = cornersOf(mesh, mesh.triangles[indexOf(triangle)]);
        tree.crossings((a + b + c) / 3, 0, true, crossings);
        std::ranges::fill(windings, 0);
        for (const TriangleTree::Crossing& crossing : crossings) {
          windings[indexOf(shells.of[indexOf(crossing.triangle)])] -= crossing.step;
        }
        for (std::size_t other = 0; other < n; ++other) {
          holders[other] += windings[other] != 0 ? 1 : 0;
        }
      }
      for (std::size_t other = 0; other < n; ++other) {
        const bool holds = other != own && holders[other] == all[own].some.size() &&
                           (all[other].low.array() <= all[own].low.array()).all() &&
                           (all[other].high.array() >= all[own].high.array()).all() &&
                           std::abs(all[other].volume_m3) > std::abs(all[own].volume_m3);
        std::int32_t& around = all[own].around;
        if (holds && (around < 0 || std::abs(all[other].volume_m3) < std::abs(all[indexOf(around)].volume_m3))) {
          around = static_cast<std::int32_t>(other);
        }
      }
      throwIfStopped();
    }
  }
  std::vector<std::size_t> by_volume(n);
  std::iota(by_volume.begin(), by_volume.end(), 0);
  std::ranges::stable_sort(
      by_volume, [&](std::size_t a, std::size_t b) { return std::abs(all[a].volume_m3) > std::abs(all[b].volume_m3); });
  Turned turned;
  std::vector<bool> turn(n);
  for (const std::size_t own : by_volume) {  // those around come first
    Shell& shell = all[own];
    shell.side = 1;
    if (shell.around >= 0 && shells.as_in_file[own] && shells.as_in_file[indexOf(shell.around)]) {
      const Shell& around = all[indexOf(shell.around)];
      const bool opposed = (shell.volume_m3 < 0) != (around.volume_m3 < 0);
      shell.side = opposed ? -around.side : around.side;
    }
    turn[own] = (shell.volume_m3 < 0) != (shell.side < 0);
    turned.parts += turn[own] ? 1 : 0;
    turned.cavities += shell.side < 0 ? 1 : 0;
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (turn[indexOf(shells.of[i])]) {
      std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
    }
  }
  return turned;
}

}  // namespace haptolith
