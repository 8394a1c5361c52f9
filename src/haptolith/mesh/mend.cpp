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
#include "haptolith/core/stop_asked.h"
#include "haptolith/mesh/mesh_edges.h"
#include "haptolith/mesh/surface_orientation.h"

namespace haptolith {

namespace {

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

/// Result of dropCopies().
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
  UnionFind parts(mesh.points_m.size());
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

/// Result of HoleCloser.
struct Holes {
  std::size_t closed = 0;
  std::size_t open = 0;
  double largest_m = 0;  ///< around an open one
};

/// Closes openings by fans; with `only_look` none.
class HoleCloser {
 public:
  HoleCloser(TriangleMesh& mesh, std::vector<std::int32_t>& patch_of, double largest_edge_m, bool only_look)
      : mesh_(mesh), patch_of_(patch_of), largest_edge_m_(largest_edge_m), only_look_(only_look) {
    forEachEdge(edgesOf(mesh), [&](std::span<const Edge> same) {
      const int more = imbalance(same);
      int missing = std::abs(more);
      for (const Edge& edge : same) {
        if (missing > 0 && edge.forward == (more > 0)) {
          rim_.push_back(edge.forward ? RimEdge{edge.high, edge.low, edge.triangle}
                                      : RimEdge{edge.low, edge.high, edge.triangle});
          --missing;
        }
      }
    });
    std::ranges::sort(rim_, [](const RimEdge& a, const RimEdge& b) {
      return std::tuple(a.from, a.to, a.triangle) < std::tuple(b.from, b.to, b.triangle);
    });
    used_.resize(rim_.size());
    cursor_.resize(rim_.size());
    std::iota(cursor_.begin(), cursor_.end(), 0);
  }

  Holes close() {
    for (std::size_t start = 0; start < rim_.size(); ++start) {
      if (!used_[start]) {
        follow(start);
      }
    }
    return holes_;
  }

 private:
  /// An edge as an opening's rim passes it: against its triangle.
  struct RimEdge {
    std::int32_t from, to, triangle;
  };

  /// Follows the rim from an edge, and closes each loop when the path returns to one of its points.
  void follow(std::size_t start) {
    std::vector<std::size_t> path{start};
    std::unordered_map<std::int32_t, std::size_t> place{{rim_[start].from, 0}};  // on the path, of each edge's start
    used_[start] = true;
    while (!path.empty()) {
      const std::int32_t end = rim_[path.back()].to;
      if (const auto before = place.find(end); before != place.end()) {
        const std::size_t from = before->second;
        closeLoop(std::span(path).subspan(from));
        for (std::size_t i = from; i < path.size(); ++i) {
          place.erase(rim_[path[i]].from);
        }
        path.resize(from);
        continue;
      }
      const std::size_t next = takeEdgeFrom(end);
      if (next == rim_.size()) {  // edges of more than two triangles can end a rim
        ++holes_.open;
        return;
      }
      place[end] = path.size();
      path.push_back(next);
    }
  }

  /// The next edge from a point that was not used yet; the number of edges when no such edge exists.
  std::size_t takeEdgeFrom(std::int32_t point) {
    const auto first =
        static_cast<std::size_t>(std::ranges::lower_bound(rim_, point, {}, &RimEdge::from) - rim_.begin());
    if (first == rim_.size()) {
      return first;
    }
    std::size_t next = std::max(first, cursor_[first]);
    while (next < rim_.size() && rim_[next].from == point && used_[next]) {
      ++next;
    }
    cursor_[first] = next;
    if (next == rim_.size() || rim_[next].from != point) {
      return rim_.size();
    }
    used_[next] = true;
    return next;
  }

  void closeLoop(std::span<const std::size_t> loop) {
    double around_m = 0;
    Vec3 middle = Vec3::Zero();
    for (const std::size_t i : loop) {
      const Vec3& from = pointAt(rim_[i].from);
      const Vec3& to = pointAt(rim_[i].to);
      around_m += (to - from).norm();
      middle += (to - from).norm() * (from + to) / 2;
    }
    if (!(around_m > 0)) {
      return;
    }
    middle /= around_m;
    double area_m2 = 0;
    for (const std::size_t i : loop) {
      area_m2 += (pointAt(rim_[i].from) - middle).cross(pointAt(rim_[i].to) - middle).norm() / 2;
    }
    const bool slit = area_m2 <= kStitch * largest_edge_m_ * around_m;
    if (only_look_ || (around_m > kLargestHole * largest_edge_m_ && !slit)) {
      ++holes_.open;
      holes_.largest_m = std::max(holes_.largest_m, around_m);
      return;
    }
    ++holes_.closed;
    if (loop.size() == 3) {
      add({rim_[loop[0]].from, rim_[loop[1]].from, rim_[loop[2]].from}, rim_[loop[0]]);
      return;
    }
    mesh_.points_m.push_back(middle);
    for (const std::size_t i : loop) {
      add({rim_[i].from, rim_[i].to, static_cast<std::int32_t>(mesh_.points_m.size() - 1)}, rim_[i]);
    }
  }

  [[nodiscard]] const Vec3& pointAt(std::int32_t point) const { return mesh_.points_m[indexOf(point)]; }
  void add(const Triangle& triangle, const RimEdge& beside) {
    mesh_.triangles.push_back(triangle);
    patch_of_.push_back(patch_of_[indexOf(beside.triangle)]);
  }

  TriangleMesh& mesh_;
  std::vector<std::int32_t>& patch_of_;
  double largest_edge_m_;
  bool only_look_;
  std::vector<RimEdge> rim_;
  std::vector<bool> used_;
  std::vector<std::size_t> cursor_;  // index of each point's next edge that may be free
  Holes holes_;
};

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
    throw InvalidParameter("mesh", "triangles without points, or points without a position",
                           "indices of finite points");
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
  throwIfStopped();
  if (size_m > 0) {
    const std::size_t stitched = stitch(mesh, kStitch * size_m);
    tell(stitched, fmt::format("Joined {} on open edges to others within {:.2g} um.", pluralise(stitched, "point"),
                               1e6 * kStitch * size_m));
  }
  tell(gone, fmt::format("Removed {} without area.", pluralise(gone, "triangle")));
  const Copies copies = dropCopies(mesh);
  tell(copies.copies, copies.two_sided
                          ? fmt::format("Removed {}: the surface had both sides.", pluralise(copies.copies, "triangle"))
                          : fmt::format("Removed {} of triangles.",
                                        copies.copies == 1 ? "1 copy" : fmt::format("{} copies", copies.copies)));
  tell(copies.inner_walls,
       fmt::format("Removed {} inside, between parts that touch.", pluralise(copies.inner_walls, "wall triangle")));
  const std::size_t loose = dropLooseParts(mesh);
  tell(loose, fmt::format("Removed {} up to {:.2g} mm.", pluralise(loose, "loose part"), 1e3 * kLoosePart * size_m));
  if (mesh.triangles.empty()) {
    throw InvalidParameter("mesh", "nothing with an area", "triangles that make up a surface");
  }
  throwIfStopped();

  Patches patches = turnNeighbours(mesh);
  tell(patches.turned, fmt::format("Flipped {} with reversed orientation.", pluralise(patches.turned, "triangle")));
  throwIfStopped();
  const Holes holes = HoleCloser(mesh, patches.of, size_m, may_be_sheet).close();
  tell(holes.closed, fmt::format("Closed {} up to {:.3g} mm around.", pluralise(holes.closed, "opening"),
                                 1e3 * kLargestHole * size_m));
  throwIfStopped();
  const Shells shells = shellsOf(mesh, patches);
  if (shells.closed && !patches.one_sided) {
    if (shells.as_in_file.size() > kMostShells) {
      throw InvalidParameter("mesh", pluralise(shells.as_in_file.size(), "part"),
                             fmt::format("a tool of at most {} closed parts", kMostShells));
    }
    const Turned turned = turnOutwards(mesh, shells);
    tell(turned.parts, fmt::format("Flipped {} (inside out).", pluralise(turned.parts, "part")));
    tell(turned.cavities, fmt::format("Kept {} (cavity, facing inwards).", pluralise(turned.cavities, "inner part")));
    mended.shells = shells.of;
    mended.shell_count = static_cast<int>(shells.as_in_file.size());
    tell(may_be_sheet ? 1 : 0, "The surface is closed and therefore solid: the sheet thickness has no effect.");
  } else if (may_be_sheet) {
    mended.sheet_thickness_m = options.sheet_thickness_m;
    mended.shells.assign(mesh.triangles.size(), 0);
    mended.shell_count = 1;
    mended.report.push_back(
        fmt::format("The surface is open: a sheet {:.3g} mm thick.", 1e3 * options.sheet_thickness_m));
  } else if (patches.one_sided) {
    throw InvalidParameter("mesh", "a one-sided surface, such as a Moebius strip",
                           "a surface with an inside, or a sheet with a thickness");
  } else {
    throw InvalidParameter(
        "mesh",
        fmt::format("open in {}, the largest {:.3g} mm around",
                    pluralise(std::max<std::size_t>(holes.open, 1), "place"), 1e3 * holes.largest_m),
        fmt::format("closed, except for openings up to {:.3g} mm around: close the surface, or set a sheet thickness",
                    1e3 * kLargestHole * size_m));
  }
  dropUnusedPoints(mesh);
  mended.mesh = std::move(mesh);
  return mended;
}

}  // namespace haptolith
