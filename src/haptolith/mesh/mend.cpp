#include "haptolith/mesh/mend.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "haptolith/core/pluralise.h"
#include "haptolith/core/process/stop_asked.h"
#include "haptolith/mesh/triangle_tree.h"

namespace haptolith {

namespace {

using Triangle = std::array<std::int32_t, 3>;

std::size_t indexOf(std::int32_t index) {
  return static_cast<std::size_t>(index);
}

void throwIfMendingStopped() {
  if (stopAsked()) {
    throw Failure("interrupted");
  }
}

/// Sets that grow together.
class Unions {
 public:
  explicit Unions(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
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

/// All edges, those between the same points together.
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

/// How much more often an edge is passed forward than backward: 0 where the surface is closed.
int imbalance(std::span<const Edge> same) {
  int sum = 0;
  for (const Edge& edge : same) {
    sum += edge.forward ? 1 : -1;
  }
  return sum;
}

double areaOf(const TriangleMesh& mesh, const Triangle& triangle) {
  const auto [a, b, c] = cornersOf(mesh, triangle);
  return (b - a).cross(c - a).norm() / 2;
}

/// Puts `now[i]` in the place of point i, and drops triangles that lose their area by it.
std::size_t renumber(TriangleMesh& mesh, const std::vector<std::int32_t>& now) {
  return std::erase_if(mesh.triangles, [&](Triangle& triangle) {
    for (std::int32_t& point : triangle) {
      point = now[indexOf(point)];
    }
    return triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
  });
}

/// Makes equal points one. @return how many triangles had two such corners.
std::size_t mergeEqualPoints(TriangleMesh& mesh) {
  const std::size_t n = mesh.points_m.size();
  for (Vec3& point_m : mesh.points_m) {
    point_m.array() += 0.0;  // -0 is 0
  }
  const auto coordinates = [&](std::int32_t i) {
    const Vec3& p = mesh.points_m[indexOf(i)];
    return std::tuple(p.x(), p.y(), p.z());
  };
  std::vector<std::int32_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](std::int32_t a, std::int32_t b) {
    return std::tuple_cat(coordinates(a), std::tuple(a)) < std::tuple_cat(coordinates(b), std::tuple(b));
  });
  // Points keep the order in which they came first: neighbours in a file stay neighbours in memory.
  std::vector<std::int32_t> first(n);
  for (std::size_t i = 0; i < n; ++i) {
    const bool same = i > 0 && coordinates(order[i]) == coordinates(order[i - 1]);
    first[indexOf(order[i])] = same ? first[indexOf(order[i - 1])] : order[i];
  }
  std::vector<std::int32_t> now(n);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (indexOf(first[i]) == i) {
      now[i] = static_cast<std::int32_t>(kept);
      mesh.points_m[kept++] = mesh.points_m[i];
    } else {
      now[i] = now[indexOf(first[i])];
    }
  }
  mesh.points_m.resize(kept);
  return renumber(mesh, now);
}

/// Makes points on open edges that nearly meet one. @return how many went.
std::size_t stitch(TriangleMesh& mesh, double reach_m) {
  std::vector<std::int32_t> open;
  forEachEdge(edgesOf(mesh), [&](std::span<const Edge> same) {
    if (same.size() == 1) {
      open.insert(open.end(), {same[0].low, same[0].high});
    }
  });
  std::ranges::sort(open);
  open.erase(std::unique(open.begin(), open.end()), open.end());
  const Vec3 low = cornersOf(mesh).low_m;
  const auto cell_of = [&](const Vec3& point_m, int dx, int dy, int dz) {
    const Vec3 cell = (point_m - low) / reach_m;  // at most 1 / kStitch
    const auto code = [](double c, int d) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(c) + d + 1); };
    return code(cell.x(), dx) << 42 | code(cell.y(), dy) << 21 | code(cell.z(), dz);
  };
  std::unordered_map<std::uint64_t, std::vector<std::int32_t>> cells;
  std::vector<std::int32_t> now(mesh.points_m.size());
  std::iota(now.begin(), now.end(), 0);
  std::size_t gone = 0;
  for (const std::int32_t point : open) {
    const Vec3& point_m = mesh.points_m[indexOf(point)];
    for (int i = 0; i < 27 && now[indexOf(point)] == point; ++i) {
      const auto cell = cells.find(cell_of(point_m, i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
      const std::span<const std::int32_t> near = cell == cells.end() ? std::span<const std::int32_t>{} : cell->second;
      const auto same = std::ranges::find_if(
          near, [&](std::int32_t other) { return (mesh.points_m[indexOf(other)] - point_m).norm() <= reach_m; });
      if (same != near.end()) {
        now[indexOf(point)] = *same;
        ++gone;
      }
    }
    if (now[indexOf(point)] == point) {
      cells[cell_of(point_m, 0, 0, 0)].push_back(point);
    }
  }
  if (gone > 0) {
    renumber(mesh, now);
  }
  return gone;
}

/// What dropCopies() found.
struct Copies {
  std::size_t copies = 0;
  std::size_t inner_walls = 0;
  bool two_sided = false;
};

/// Leaves one of triangles with the same corners; of pairs that look in opposite directions none, or one when the
/// mesh is drawn from both sides.
Copies dropCopies(TriangleMesh& mesh) {
  struct Key {
    Triangle corners;  ///< ascending
    std::int32_t triangle;
    bool odd;  ///< whether the triangle passes them the other way round
  };
  std::vector<Key> keys;
  keys.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Triangle t = mesh.triangles[i];
    std::rotate(t.begin(), std::ranges::min_element(t), t.end());
    const bool odd = t[1] > t[2];
    if (odd) {
      std::swap(t[1], t[2]);
    }
    keys.push_back({t, static_cast<std::int32_t>(i), odd});
  }
  std::ranges::sort(keys, [](const Key& a, const Key& b) {
    return std::tie(a.corners, a.triangle) < std::tie(b.corners, b.triangle);
  });
  Copies found;
  std::vector<bool> goes(mesh.triangles.size());
  std::vector<std::int32_t> pairs;  // the first of each
  for (std::size_t i = 0; i < keys.size();) {
    std::size_t end = i;
    int net = 0;
    for (; end < keys.size() && keys[end].corners == keys[i].corners; ++end) {
      net += keys[end].odd ? -1 : 1;
    }
    if (net == 0) {
      pairs.push_back(keys[i].triangle);
    }
    bool kept = false;
    for (std::size_t j = i; j < end; ++j) {
      const bool keep = !kept && (net == 0 || keys[j].odd == (net < 0));
      kept = kept || keep;
      goes[indexOf(keys[j].triangle)] = !keep;
      found.copies += keep ? 0 : 1;
    }
    i = end;
  }
  const std::size_t distinct = keys.size() - found.copies;
  found.two_sided = 2 * pairs.size() > distinct;
  if (!found.two_sided) {
    found.inner_walls = pairs.size();
    found.copies -= pairs.size();
    for (const std::int32_t triangle : pairs) {
      goes[indexOf(triangle)] = true;
    }
  }
  std::size_t i = 0;
  std::erase_if(mesh.triangles, [&](const Triangle&) { return goes[i++]; });
  return found;
}

/// Drops parts that hang together with nothing and are tiny. @return how many.
std::size_t dropLooseParts(TriangleMesh& mesh) {
  Unions parts(mesh.points_m.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    parts.unite(a, b);
    parts.unite(b, c);
  }
  struct Part {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = -low;
    double area_m2 = 0;
  };
  std::vector<Part> found(mesh.points_m.size());
  double whole_m2 = 0;
  for (const Triangle& triangle : mesh.triangles) {
    Part& part = found[indexOf(parts.find(triangle[0]))];
    for (const Vec3& corner : cornersOf(mesh, triangle)) {
      part.low = part.low.cwiseMin(corner);
      part.high = part.high.cwiseMax(corner);
    }
    part.area_m2 += areaOf(mesh, triangle);
    whole_m2 += areaOf(mesh, triangle);
  }
  const double tiny_m = kLoosePart * cornersOf(mesh).largestEdge();
  const auto is_tiny = [&](const Part& part) { return (part.high - part.low).maxCoeff() <= tiny_m; };
  double tiny_m2 = 0;
  std::size_t gone = 0;
  for (const Part& part : found) {
    const bool there = part.high.x() >= part.low.x();
    tiny_m2 += there && is_tiny(part) ? part.area_m2 : 0;
    gone += there && is_tiny(part) ? 1 : 0;
  }
  if (gone == 0 || tiny_m2 > kMostLooseArea * whole_m2) {
    return 0;
  }
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return is_tiny(found[indexOf(parts.find(t[0]))]); });
  return gone;
}

/// Parts of a surface within which each edge has one or two triangles, all turned to look the same way.
struct Patches {
  std::vector<std::int32_t> of;  ///< of each triangle
  std::vector<bool> as_in_file;  ///< of each patch: none of its triangles was turned
  std::size_t turned = 0;        ///< triangles
  bool one_sided = false;        ///< there is one that has no two sides, such as a Moebius strip
};

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

/// What closeHoles() found.
struct Holes {
  std::size_t closed = 0;
  std::size_t open = 0;
  double largest_m = 0;  ///< around an open one
};

/// Closes openings by fans; with `only_look` none.
Holes closeHoles(TriangleMesh& mesh, std::vector<std::int32_t>& patch_of, double largest_edge_m, bool only_look) {
  // Edges as an opening's rim passes them: against its triangle.
  struct RimEdge {
    std::int32_t from, to, triangle;
  };
  std::vector<RimEdge> rim;
  forEachEdge(edgesOf(mesh), [&](std::span<const Edge> same) {
    const int more = imbalance(same);
    int missing = std::abs(more);
    for (const Edge& edge : same) {
      if (missing > 0 && edge.forward == (more > 0)) {
        rim.push_back(edge.forward ? RimEdge{edge.high, edge.low, edge.triangle}
                                   : RimEdge{edge.low, edge.high, edge.triangle});
        --missing;
      }
    }
  });
  std::ranges::sort(rim, [](const RimEdge& a, const RimEdge& b) {
    return std::tuple(a.from, a.to, a.triangle) < std::tuple(b.from, b.to, b.triangle);
  });
  const auto next_from = [&](std::int32_t point) {
    return static_cast<std::size_t>(std::ranges::lower_bound(rim, point, {}, &RimEdge::from) - rim.begin());
  };
  std::vector<bool> used(rim.size());
  std::vector<std::size_t> cursor(rim.size());  // of the first edge of each point: the next that may be free
  std::iota(cursor.begin(), cursor.end(), 0);
  Holes holes;
  std::vector<std::size_t> path;
  std::unordered_map<std::int32_t, std::size_t> place;  // on the path, of each edge's start
  const auto close = [&](std::span<const std::size_t> loop) {
    double around_m = 0;
    Vec3 middle = Vec3::Zero();
    for (const std::size_t i : loop) {
      const Vec3& from = mesh.points_m[indexOf(rim[i].from)];
      const Vec3& to = mesh.points_m[indexOf(rim[i].to)];
      around_m += (to - from).norm();
      middle += (to - from).norm() * (from + to) / 2;
    }
    if (!(around_m > 0)) {
      return;
    }
    middle /= around_m;
    double area_m2 = 0;
    for (const std::size_t i : loop) {
      area_m2 +=
          (mesh.points_m[indexOf(rim[i].from)] - middle).cross(mesh.points_m[indexOf(rim[i].to)] - middle).norm() / 2;
    }
    const bool slit = area_m2 <= kStitch * largest_edge_m * around_m;
    if (only_look || (around_m > kLargestHole * largest_edge_m && !slit)) {
      ++holes.open;
      holes.largest_m = std::max(holes.largest_m, around_m);
      return;
    }
    ++holes.closed;
    if (loop.size() == 3) {
      mesh.triangles.push_back({rim[loop[0]].from, rim[loop[1]].from, rim[loop[2]].from});
      patch_of.push_back(patch_of[indexOf(rim[loop[0]].triangle)]);
      return;
    }
    mesh.points_m.push_back(middle);
    for (const std::size_t i : loop) {
      mesh.triangles.push_back({rim[i].from, rim[i].to, static_cast<std::int32_t>(mesh.points_m.size() - 1)});
      patch_of.push_back(patch_of[indexOf(rim[i].triangle)]);
    }
  };
  for (std::size_t start = 0; start < rim.size(); ++start) {
    if (used[start]) {
      continue;
    }
    path.assign(1, start);
    place.clear();
    place[rim[start].from] = 0;
    used[start] = true;
    while (!path.empty()) {
      const std::int32_t end = rim[path.back()].to;
      if (const auto before = place.find(end); before != place.end()) {
        const std::size_t from = before->second;
        close(std::span(path).subspan(from));
        for (std::size_t i = from; i < path.size(); ++i) {
          place.erase(rim[path[i]].from);
        }
        path.resize(from);
        continue;
      }
      const std::size_t first = next_from(end);
      std::size_t next = first < rim.size() ? std::max(first, cursor[first]) : first;
      while (next < rim.size() && rim[next].from == end && used[next]) {
        ++next;
      }
      if (first < rim.size()) {
        cursor[first] = next;
      }
      if (next >= rim.size() || rim[next].from != end) {  // edges of more than two triangles can end a rim
        ++holes.open;
        break;
      }
      used[next] = true;
      place[end] = path.size();
      path.push_back(next);
    }
  }
  return holes;
}

/// Closed parts: patches, or several that meet in edges of more than two triangles and are closed together.
struct Shells {
  std::vector<std::int32_t> of;  ///< of each triangle
  std::vector<bool> as_in_file;
  bool closed = true;
};

Shells shellsOf(const TriangleMesh& mesh, const Patches& patches) {
  const std::size_t n = patches.as_in_file.size();
  std::vector<Edge> edges = edgesOf(mesh);
  // A patch that is closed by itself passes each of its edges as often forward as backward.
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
  Unions together(n);
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

/// What turnOutwards() did.
struct Turned {
  std::size_t parts = 0;
  std::size_t cavities = 0;
};

/// Turns closed parts to look outwards, and cavities inwards.
Turned turnOutwards(TriangleMesh& mesh, const Shells& shells) {
  const std::size_t n = shells.as_in_file.size();
  struct Shell {
    double volume_m3 = 0;  ///< negative when it looks inwards
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = -low;
    std::vector<std::int32_t> some;  ///< triangles to tell where it lies
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
      throwIfMendingStopped();
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

void dropUnusedPoints(TriangleMesh& mesh) {
  std::vector<std::int32_t> now(mesh.points_m.size(), -1);
  std::vector<Vec3> kept;
  for (Triangle& triangle : mesh.triangles) {
    for (std::int32_t& point : triangle) {
      if (now[indexOf(point)] < 0) {
        now[indexOf(point)] = static_cast<std::int32_t>(kept.size());
        kept.push_back(mesh.points_m[indexOf(point)]);
      }
      point = now[indexOf(point)];
    }
  }
  mesh.points_m = std::move(kept);
}

void requireSound(const TriangleMesh& mesh) {
  const auto known = [&](const Triangle& t) {
    return std::ranges::all_of(t, [&](std::int32_t i) { return i >= 0 && indexOf(i) < mesh.points_m.size(); });
  };
  if (!std::ranges::all_of(mesh.triangles, known) ||
      !std::ranges::all_of(mesh.points_m, [](const Vec3& point_m) { return point_m.allFinite(); })) {
    throw InvalidParameter("mesh", "triangles without points, or points without a place", "indices of finite points");
  }
}

}  // namespace

MendedMesh mend(TriangleMesh mesh, const MendOptions& options) {
  requireInRange("sheet_thickness_m", options.sheet_thickness_m, kSheetThickness_m);
  requireSound(mesh);
  const bool may_be_sheet = options.sheet_thickness_m > 0;
  MendedMesh mended;
  const auto tell = [&](std::size_t count, std::string sentence) {
    if (count > 0) {
      mended.report.push_back(std::move(sentence));
    }
  };

  std::size_t gone = mergeEqualPoints(mesh);
  const double size_m = cornersOf(mesh).largestEdge();
  throwIfMendingStopped();
  if (size_m > 0) {
    const std::size_t stitched = stitch(mesh, kStitch * size_m);
    tell(stitched, fmt::format("Joined {} on open edges to others within {:.2g} um.", pluralise(stitched, "point"),
                               1e6 * kStitch * size_m));
  }
  tell(gone, fmt::format("Left out {} without area.", pluralise(gone, "triangle")));
  const Copies copies = dropCopies(mesh);
  tell(copies.copies,
       copies.two_sided
           ? fmt::format("Left out {}: the surface was drawn from both sides.", pluralise(copies.copies, "triangle"))
           : fmt::format("Left out {} of others.",
                         copies.copies == 1 ? "1 copy" : fmt::format("{} copies", copies.copies)));
  tell(copies.inner_walls,
       fmt::format("Left out {} inside, between parts that touch.", pluralise(copies.inner_walls, "wall triangle")));
  const std::size_t loose = dropLooseParts(mesh);
  tell(loose, fmt::format("Left out {} up to {:.2g} mm.", pluralise(loose, "loose part"), 1e3 * kLoosePart * size_m));
  if (mesh.triangles.empty()) {
    throw InvalidParameter("mesh", "nothing with an area", "triangles that make up a surface");
  }
  throwIfMendingStopped();

  Patches patches = turnNeighbours(mesh);
  tell(patches.turned, fmt::format("Turned {} that looked the other way than the surface around.",
                                   pluralise(patches.turned, "triangle")));
  throwIfMendingStopped();
  const Holes holes = closeHoles(mesh, patches.of, size_m, may_be_sheet);
  tell(holes.closed, fmt::format("Closed {} up to {:.3g} mm around.", pluralise(holes.closed, "opening"),
                                 1e3 * kLargestHole * size_m));
  throwIfMendingStopped();
  const Shells shells = shellsOf(mesh, patches);
  if (shells.closed && !patches.one_sided) {
    if (shells.as_in_file.size() > kMostShells) {
      throw InvalidParameter("mesh", pluralise(shells.as_in_file.size(), "part"),
                             fmt::format("a tool of at most {} closed parts", kMostShells));
    }
    const Turned turned = turnOutwards(mesh, shells);
    tell(turned.parts, fmt::format("Turned {} inside out.", pluralise(turned.parts, "part")));
    tell(turned.cavities,
         fmt::format("Kept {} as a cavity each, since they look inwards.", pluralise(turned.cavities, "inner part")));
    mended.shells = shells.of;
    mended.shell_count = static_cast<int>(shells.as_in_file.size());
    tell(may_be_sheet ? 1 : 0, "The surface is closed, so it is solid: the thickness of a sheet has no effect.");
  } else if (may_be_sheet) {
    mended.sheet_thickness_m = options.sheet_thickness_m;
    mended.shells.assign(mesh.triangles.size(), 0);
    mended.shell_count = 1;
    mended.report.push_back(
        fmt::format("The surface is open: a sheet {:.3g} mm thick.", 1e3 * options.sheet_thickness_m));
  } else if (patches.one_sided) {
    throw InvalidParameter("mesh", "a surface with one side, like a Moebius strip",
                           "a surface with an inside, or a sheet with a thickness");
  } else {
    throw InvalidParameter(
        "mesh",
        fmt::format("open in {}, the largest {:.3g} mm around",
                    pluralise(std::max<std::size_t>(holes.open, 1), "place"), 1e3 * holes.largest_m),
        fmt::format(
            "closed, but for openings up to {:.3g} mm around: close it where it was made, or give the thickness "
            "of a sheet",
            1e3 * kLargestHole * size_m));
  }
  dropUnusedPoints(mesh);
  mended.mesh = std::move(mesh);
  return mended;
}

}  // namespace haptolith
