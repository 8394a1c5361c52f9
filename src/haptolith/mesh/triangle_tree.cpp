#include "haptolith/mesh/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "haptolith/core/process/in_parallel.h"

namespace haptolith {

namespace {

double squaredDistanceToLine(const Vec3& point_m, const Vec3& a, const Vec3& b) noexcept {
  const Vec3 ab = b - a;
  const double length2 = ab.squaredNorm();
  const double along = length2 > 0 ? std::clamp((point_m - a).dot(ab) / length2, 0.0, 1.0) : 0;
  return (point_m - a - along * ab).squaredNorm();
}

}  // namespace

double squaredDistance(const Vec3& point_m, const std::array<Vec3, 3>& triangle_m) noexcept {
  // Ericson, Real-Time Collision Detection (2005), 5.1.5: by the region of corners, edges and the face that the point's
  // projection is in.
  const auto& [a, b, c] = triangle_m;
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ap = point_m - a;
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) {
    return ap.squaredNorm();
  }
  const Vec3 bp = point_m - b;
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) {
    return bp.squaredNorm();
  }
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    return squaredDistanceToLine(point_m, a, b);
  }
  const Vec3 cp = point_m - c;
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) {
    return cp.squaredNorm();
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    return squaredDistanceToLine(point_m, a, c);
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return squaredDistanceToLine(point_m, b, c);
  }
  const Vec3 normal = ab.cross(ac);
  const double area2 = normal.squaredNorm();
  // A sliver's face is indistinguishable from its edges.
  if (area2 <= 1e-24 * ab.squaredNorm() * ac.squaredNorm()) {
    return std::min({squaredDistanceToLine(point_m, a, b), squaredDistanceToLine(point_m, a, c),
                     squaredDistanceToLine(point_m, b, c)});
  }
  const double height = normal.dot(ap);
  return height * height / area2;
}

struct TriangleTree::Item {
  Vec3 centre_m;
  std::int32_t triangle;
};

/// Distribution of n triangles among a node's branches: by number, so that the offset of each branch's nodes
/// is known, and they can be made in parallel.
std::array<std::size_t, TriangleTree::kBranches> TriangleTree::shares(std::size_t n) noexcept {
  const std::size_t half = n / 2;
  return {half / 2, half - half / 2, (n - half) / 2, n - half - (n - half) / 2};
}

std::size_t TriangleTree::nodesFor(std::size_t n) noexcept {
  if (n <= 1) {
    return 0;  // in its parent
  }
  // Branches differ by one triangle at most, so there are two sizes a level.
  std::size_t sum = 1;
  std::size_t last_n = 0;
  std::size_t last = 0;
  for (const std::size_t share : shares(n)) {
    last = share == last_n ? last : nodesFor(share);
    last_n = share;
    sum += last;
  }
  return sum;
}

std::size_t TriangleTree::split(std::span<Item> items) {
  const std::size_t half = items.size() / 2;
  if (half == 0) {
    return 0;
  }
  Vec3 low = items.front().centre_m;
  Vec3 high = low;
  for (const Item& item : items) {
    low = low.cwiseMin(item.centre_m);
    high = high.cwiseMax(item.centre_m);
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  std::ranges::nth_element(items, items.begin() + static_cast<std::ptrdiff_t>(half), [&](const Item& a, const Item& b) {
    return std::pair(a.centre_m[axis], a.triangle) < std::pair(b.centre_m[axis], b.triangle);
  });
  return half;
}

/// Box and disc of a branch.
void TriangleTree::describe(std::span<const Item> items, Node& node, int i) const {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
  Vec3 normal = Vec3::Zero();
  for (const Item& item : items) {
    const auto [a, b, c] = cornersOf(*mesh_, mesh_->triangles[static_cast<std::size_t>(item.triangle)]);
    low = low.cwiseMin(a).cwiseMin(b).cwiseMin(c);
    high = high.cwiseMax(a).cwiseMax(b).cwiseMax(c);
    normal += (b - a).cross(c - a);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto e = static_cast<Eigen::Index>(axis);
    node.low_m[axis][i] = std::nextafter(static_cast<float>(low[e] - middle_m_[e]), -kFar);
    node.high_m[axis][i] = std::nextafter(static_cast<float>(high[e] - middle_m_[e]), kFar);
  }
  constexpr std::size_t kMost = 2048;  // larger pieces are seldom flat
  const double length = normal.norm();
  if (items.size() > kMost || !(length > 0)) {
    return;
  }
  Vec3 disc_m;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto e = static_cast<Eigen::Index>(axis);
    node.disc_m[axis][i] = (node.low_m[axis][i] + node.high_m[axis][i]) / 2;
    node.normal[axis][i] = static_cast<float>(normal[e] / length);
    disc_m[e] = node.disc_m[axis][i] + middle_m_[e];
    normal[e] = node.normal[axis][i];
  }
  double half_thickness_m = 0;
  double radius2_m2 = 0;
  for (const Item& item : items) {
    for (const Vec3& corner : cornersOf(*mesh_, mesh_->triangles[static_cast<std::size_t>(item.triangle)])) {
      const double height = (corner - disc_m).dot(normal);
      half_thickness_m = std::max(half_thickness_m, std::abs(height));
      radius2_m2 = std::max(radius2_m2, (corner - disc_m).squaredNorm() - height * height);
    }
  }
  node.half_thickness_m[i] = std::nextafter(static_cast<float>(half_thickness_m), kFar);
  node.radius_m[i] = std::nextafter(static_cast<float>(std::sqrt(radius2_m2)), kFar);
}

void TriangleTree::build(std::span<Item> items, std::size_t index, std::size_t first, int threads) {
  Node& node = nodes_[index];
  constexpr float kNone = 1e30F;  // far from everything; thin nowhere
  for (std::size_t axis = 0; axis < 3; ++axis) {
    node.low_m[axis].fill(kNone);
    node.high_m[axis].fill(kNone);
    node.disc_m[axis].fill(0);
    node.normal[axis].fill(0);
  }
  node.half_thickness_m.fill(kNone);
  node.radius_m.fill(kNone);
  node.branch.fill(0);
  const std::size_t half = split(items);
  (void)split(items.first(half));
  (void)split(items.subspan(half));
  struct Branch {
    std::span<Item> items;
    std::size_t node, first;
  };
  std::array<Branch, kBranches> branches;
  std::size_t begin = 0;
  std::size_t next = index + 1;
  for (std::size_t i = 0; i < kBranches; ++i) {
    const std::size_t share = shares(items.size())[i];
    branches[i] = {items.subspan(begin, share), next, first + begin};
    begin += share;
    next += nodesFor(share);
  }
  constexpr std::size_t kWorthSharing = 10'000;
  inParallel(kBranches, items.size() < kWorthSharing ? 1 : threads, [&](std::size_t i) {
    const Branch& branch = branches[i];
    if (branch.items.empty()) {
      return;
    }
    describe(branch.items, node, static_cast<int>(i));
    if (branch.items.size() == 1) {
      node.branch[i] = ~static_cast<std::int32_t>(branch.first);
    } else {
      node.branch[i] = static_cast<std::int32_t>(branch.node);
      build(branch.items, branch.node, branch.first, 1);
    }
  });
}

TriangleTree::TriangleTree(const TriangleMesh& mesh, int threads) : mesh_(&mesh) {
  const std::size_t n = mesh.triangles.size();
  std::vector<Item> items(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto [a, b, c] = cornersOf(mesh, mesh.triangles[i]);
    items[i] = {(a + b + c) / 3, static_cast<std::int32_t>(i)};
  }
  const MeshCorners corners = cornersOf(mesh);
  middle_m_ = (corners.low_m + corners.high_m) / 2;
  half_diagonal_m_ = (corners.high_m - corners.low_m).norm() / 2;
  nodes_.resize(std::max<std::size_t>(1, nodesFor(n)));
  build(items, 0, 0, threads);
  corners_m_.reserve(n);
  triangles_.reserve(n);
  for (const Item& item : items) {
    corners_m_.push_back(cornersOf(mesh, mesh.triangles[static_cast<std::size_t>(item.triangle)]));
    triangles_.push_back(item.triangle);
  }
  mesh_ = nullptr;
}

bool TriangleTree::within(const Vec3& point_m, double most_m, std::size_t most, std::vector<Near>& found) const {
  found.clear();
  const Vec3 reach_m = Vec3::Constant(most_m);
  forEachNear(
      [&](const Node& node, int i) {
        return found.size() <= most && meets(node, i, point_m - reach_m - middle_m_, point_m + reach_m - middle_m_);
      },
      [&](std::int32_t place) {
        const double distance_m = std::sqrt(squaredDistance(point_m, corners_m_[static_cast<std::size_t>(place)]));
        if (distance_m < most_m) {
          found.push_back({distance_m, place});
        }
      });
  if (found.size() > most) {
    return false;
  }
  std::ranges::sort(found, {}, &Near::distance_m);
  return true;
}

double TriangleTree::squaredDistanceTo(const Vec3& point_m, double most_m, std::span<const Near> near,
                                       double away_m) const noexcept {
  double best_m2 = most_m * most_m;
  double best_m = most_m;
  for (const Near& one : near) {
    if (one.distance_m - away_m > best_m) {
      break;  // nor are those after it nearer
    }
    const double squared_m2 = squaredDistance(point_m, corners_m_[static_cast<std::size_t>(one.place)]);
    if (squared_m2 < best_m2) {
      best_m2 = squared_m2;
      best_m = std::sqrt(squared_m2);
    }
  }
  return best_m2;
}

TriangleTree::Nearest TriangleTree::nearest(const Vec3& point_m, double most_m, std::int32_t hint) const noexcept {
  Nearest best{most_m * most_m, -1};
  if (hint >= 0) {
    const double squared_m2 = squaredDistance(point_m, corners_m_[static_cast<std::size_t>(hint)]);
    if (squared_m2 < best.squared_m2) {
      best = {squared_m2, hint};
    }
  }
  const Vec3 from_middle_m = point_m - middle_m_;
  const Eigen::Vector3f p = from_middle_m.cast<float>();
  // Floats decide which branches are too far; the distances themselves are doubles. With coordinates up to s the square
  // of a bound L is wrong by 1e-6 s (L + size of the disc), from the rounding of points, normals and products.
  const auto rounding_m = static_cast<float>(2e-6 * (from_middle_m.norm() + half_diagonal_m_));
  struct Waiting {
    float lowest_m2;
    std::int32_t branch;
  };
  constexpr std::size_t kMostWaiting = kBranches * kDeepest;
  std::array<Waiting, kMostWaiting> waiting;
  waiting[0] = {0, 0};
  std::size_t depth = 1;
  while (depth > 0) {
    const Waiting next = waiting[--depth];
    if (next.lowest_m2 >= best.squared_m2) {
      continue;
    }
    if (next.branch < 0) {
      const std::int32_t place = ~next.branch;
      const double squared_m2 = squaredDistance(point_m, corners_m_[static_cast<std::size_t>(place)]);
      if (squared_m2 < best.squared_m2) {
        best = {squared_m2, place};
      }
      continue;
    }
    const Node& node = nodes_[static_cast<std::size_t>(next.branch)];
    const auto near_m = static_cast<float>(std::sqrt(best.squared_m2));
    Node::Four box_m2 = Node::Four::Zero();
    Node::Four height = Node::Four::Zero();
    Node::Four beside_m2 = Node::Four::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float along = p[static_cast<Eigen::Index>(axis)];
      box_m2 += (node.low_m[axis] - along).max(along - node.high_m[axis]).max(0.0F).square();
      const Node::Four from_disc = along - node.disc_m[axis];
      height += from_disc * node.normal[axis];
      beside_m2 += from_disc.square();
    }
    const Node::Four over = (height.abs() - node.half_thickness_m).max(0.0F);
    const Node::Four beside = ((beside_m2 - height.square()).max(0.0F).sqrt() - node.radius_m).max(0.0F);
    const Node::Four size_m = node.half_thickness_m + node.radius_m;
    const Node::Four lowest_m2 =
        (box_m2 - rounding_m * (near_m + rounding_m))
            .max(over.square() + beside.square() - rounding_m * (near_m + rounding_m + size_m));
    std::size_t begin = depth;
    for (int i = 0; i < kBranches; ++i) {
      if (node.branch[static_cast<std::size_t>(i)] == 0 || lowest_m2[i] >= best.squared_m2) {
        continue;
      }
      std::size_t place = depth++;  // the nearest on top
      for (; place > begin && waiting[place - 1].lowest_m2 < lowest_m2[i]; --place) {
        waiting[place] = waiting[place - 1];
      }
      waiting[place] = {lowest_m2[i], node.branch[static_cast<std::size_t>(i)]};
    }
  }
  return best;
}

namespace {

/// Intersection of an edge's projection with the line v = p.v, if any: v of one end above p.v, of the other
/// not. The ends are taken in one order, so that both triangles of the edge find the same.
struct Side {
  bool meets = false;
  bool up = false;      ///< from a to b, v grows
  bool beyond = false;  ///< the place has u > p.u
};

Side sideOf(const Vec3& a, const Vec3& b, const Vec3& p, Eigen::Index u, Eigen::Index v) noexcept {
  Side side{.meets = (a[v] > p[v]) != (b[v] > p[v]), .up = b[v] > p[v]};
  if (side.meets) {
    const Vec3& low = side.up ? a : b;
    const Vec3& high = side.up ? b : a;
    const double at = low[u] + (p[v] - low[v]) / (high[v] - low[v]) * (high[u] - low[u]);
    side.beyond = at > p[u];
  }
  return side;
}

}  // namespace

void TriangleTree::crossings(const Vec3& point_m, int axis, bool forward, std::vector<Crossing>& found) const {
  found.clear();
  const Eigen::Index w = axis;
  const Eigen::Index u = (axis + 1) % 3;
  const Eigen::Index v = (axis + 2) % 3;
  Vec3 low = point_m;
  Vec3 high = point_m;
  (forward ? high : low)[w] = (forward ? 1 : -1) * std::numeric_limits<double>::infinity();
  low -= middle_m_;
  high -= middle_m_;
  forEachNear([&](const Node& node, int i) { return meets(node, i, low, high); },
              [&](std::int32_t i) {
                const auto& t = corners_m_[static_cast<std::size_t>(i)];
                int step = 0;
                for (std::size_t corner = 0; corner < 3; ++corner) {
                  const Side side = sideOf(t[corner], t[(corner + 1) % 3], point_m, u, v);
                  step += side.meets && side.beyond ? (side.up ? 1 : -1) : 0;
                }
                if (step == 0) {
                  return;  // the triangle's shadow does not hold the point
                }
                // Seen against the axis a triangle that goes counter-clockwise looks along the axis: there a line goes
                // out.
                const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
                double at_m = (t[0][w] + t[1][w] + t[2][w]) / 3;
                if (normal[w] != 0) {
                  at_m =
                      t[0][w] - ((point_m[u] - t[0][u]) * normal[u] + (point_m[v] - t[0][v]) * normal[v]) / normal[w];
                }
                at_m = std::clamp(at_m, std::min({t[0][w], t[1][w], t[2][w]}), std::max({t[0][w], t[1][w], t[2][w]}));
                if (forward ? at_m > point_m[w] : at_m < point_m[w]) {
                  found.push_back({at_m, -step, triangles_[static_cast<std::size_t>(i)]});
                }
              });
}

int TriangleTree::winding(const Vec3& point_m, int axis) const {
  thread_local std::vector<Crossing> found;
  crossings(point_m, axis, true, found);
  int sum = 0;
  for (const Crossing& crossing : found) {
    sum -= crossing.step;
  }
  return sum;
}

void TriangleTree::hits(const Vec3& from_m, const Vec3& unit_direction, std::vector<Hit>& found) const {
  found.clear();
  const Vec3 inverse = unit_direction.cwiseInverse();  // infinite ones compare correctly, except 0 * infinity
  const Vec3 from_middle_m = from_m - middle_m_;
  const auto enters = [&](const Node& node, int i) {
    double near = 0;
    double far = std::numeric_limits<double>::infinity();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto e = static_cast<Eigen::Index>(axis);
      const double a = (node.low_m[axis][i] - from_middle_m[e]) * inverse[e];
      const double b = (node.high_m[axis][i] - from_middle_m[e]) * inverse[e];
      near = std::max(near, std::min(a, b));  // std::max and std::min keep the first of a number and NaN
      far = std::min(far, std::max(a, b));
    }
    return near <= far;
  };
  forEachNear(enters, [&](std::int32_t i) {
    // Moeller and Trumbore, J. Graphics Tools 2 (1997) 21.
    const auto& [a, b, c] = corners_m_[static_cast<std::size_t>(i)];
    const Vec3 ab = b - a;
    const Vec3 ac = c - a;
    const Vec3 p = unit_direction.cross(ac);
    const double volume = ab.dot(p);
    const Vec3 from_a = from_m - a;
    const Vec3 q = from_a.cross(ab);
    const double u = from_a.dot(p) / volume;
    const double v = unit_direction.dot(q) / volume;
    const double distance_m = ac.dot(q) / volume;
    if (u >= 0 && v >= 0 && u + v <= 1 && distance_m > 0) {  // false where volume is 0
      found.push_back({distance_m, triangles_[static_cast<std::size_t>(i)]});
    }
  });
}

}  // namespace haptolith
