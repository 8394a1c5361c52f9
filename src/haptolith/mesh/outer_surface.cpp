#include "haptolith/mesh/outer_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "haptolith/core/process/in_parallel.h"
#include "haptolith/core/stop_asked.h"

namespace haptolith {

namespace {

/// Distance from the surface for the inside test, in m: less than any part that can be felt, and more than
/// coordinates are rounded.
constexpr double kBeside_m = 1e-6;
/// Pieces of one triangle: a bound for the work.
constexpr std::size_t kMostPieces = 100'000;
/// Triangles for one thread at a time.
constexpr std::size_t kChunk = 256;

struct Box {
  Vec3 low_m = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high_m = -low_m;

  void take(const std::array<Vec3, 3>& corners_m) {
    for (const Vec3& corner : corners_m) {
      low_m = low_m.cwiseMin(corner);
      high_m = high_m.cwiseMax(corner);
    }
  }
  [[nodiscard]] bool meets(const Box& other) const {
    return (low_m.array() <= other.high_m.array()).all() && (high_m.array() >= other.low_m.array()).all();
  }
};

class OuterSurface {
 public:
  OuterSurface(const MendedMesh& solid, const TriangleTree& tree, double finest_m)
      : solid_(solid), tree_(tree), finest_m_(finest_m) {
    std::vector<Box> boxes(static_cast<std::size_t>(solid.shell_count));
    for (std::size_t i = 0; i < solid.mesh.triangles.size(); ++i) {
      boxes[static_cast<std::size_t>(solid.shells[i])].take(cornersOf(solid.mesh, solid.mesh.triangles[i]));
    }
    for (std::size_t own = 0; own < boxes.size(); ++own) {
      alone_.push_back(true);
      for (std::size_t other = 0; other < boxes.size(); ++other) {
        alone_[own] = alone_[own] && (other == own || !boxes[own].meets(boxes[other]));
      }
    }
  }

  /// Adds what stays of a triangle to `kept`.
  void add(std::size_t triangle, std::vector<std::array<Vec3, 3>>& kept) const {
    const std::array<Vec3, 3> whole = cornersOf(solid_.mesh, solid_.mesh.triangles[triangle]);
    const std::int32_t shell = solid_.shells[triangle];
    const Vec3 normal = (whole[1] - whole[0]).cross(whole[2] - whole[0]);
    const bool alone = alone_[static_cast<std::size_t>(shell)];
    if (!alone && !(normal.norm() > 0)) {
      return;  // its edges belong to others
    }
    Cutting cutting{.shell = shell, .beside_m = kBeside_m * normal.normalized(), .kept = kept};
    normal.cwiseAbs().maxCoeff(&cutting.axis);
    if (alone || staysWhole(whole, cutting)) {
      kept.push_back(whole);
    }
  }

 private:
  /// Cutting of one triangle.
  struct Cutting {
    std::int32_t shell;
    Vec3 beside_m;  ///< from its surface to outside
    std::vector<std::array<Vec3, 3>>& kept;
    Eigen::Index axis = 0;
    std::size_t pieces = 1;
  };

  /// Whether all of a piece stays; of one that does not, adds what does.
  bool staysWhole(const std::array<Vec3, 3>& piece, Cutting& cutting) const {
    Box box;
    box.take(piece);
    std::size_t longest = 0;
    std::array<double, 3> length_m{};
    for (std::size_t edge = 0; edge < 3; ++edge) {
      length_m[edge] = (piece[(edge + 1) % 3] - piece[edge]).norm();
      longest = length_m[edge] > length_m[longest] ? edge : longest;
    }
    const auto is_of_another = [&](std::int32_t other) {
      return solid_.shells[static_cast<std::size_t>(other)] != cutting.shell;
    };
    if (length_m[longest] <= finest_m_ || cutting.pieces >= kMostPieces ||
        !tree_.anyInBox(box.low_m, box.high_m, is_of_another)) {
      const Vec3 centre_m = (piece[0] + piece[1] + piece[2]) / 3;
      return tree_.winding(centre_m + cutting.beside_m, static_cast<int>(cutting.axis)) == 0;
    }
    const Vec3& from = piece[longest];
    const Vec3& to = piece[(longest + 1) % 3];
    const Vec3& tip = piece[(longest + 2) % 3];
    const Vec3 middle = (from + to) / 2;
    ++cutting.pieces;
    const std::array<Vec3, 3> one{from, middle, tip};
    const std::array<Vec3, 3> other{middle, to, tip};
    const bool one_stays = staysWhole(one, cutting);
    const bool other_stays = staysWhole(other, cutting);
    if (one_stays != other_stays) {
      cutting.kept.push_back(one_stays ? one : other);
    }
    return one_stays && other_stays;
  }

  const MendedMesh& solid_;
  const TriangleTree& tree_;
  double finest_m_;
  std::vector<bool> alone_;  // shells whose box meets no other's
};

}  // namespace

TriangleMesh outerSurface(const MendedMesh& solid, const TriangleTree& tree, double finest_m, int threads) {
  const OuterSurface surface(solid, tree, finest_m);
  const std::size_t n = solid.mesh.triangles.size();
  std::vector<std::vector<std::array<Vec3, 3>>> kept((n + kChunk - 1) / kChunk);
  inParallel(kept.size(), threads, [&](std::size_t chunk) {
    for (std::size_t i = chunk * kChunk; i < std::min(n, (chunk + 1) * kChunk) && !stopAsked(); ++i) {
      surface.add(i, kept[chunk]);
    }
  });
  TriangleMesh outer;
  for (const std::vector<std::array<Vec3, 3>>& part : kept) {
    for (const std::array<Vec3, 3>& corners : part) {
      const auto first = static_cast<std::int32_t>(outer.points_m.size());
      outer.points_m.insert(outer.points_m.end(), corners.begin(), corners.end());
      outer.triangles.push_back({first, first + 1, first + 2});
    }
  }
  return outer;
}

double thinnestWall(const MendedMesh& solid, const TriangleTree& tree, int threads) {
  constexpr std::size_t kRays = 20'000;
  constexpr double kCounts = 0.01;         // fraction of the surface
  constexpr double kParallel = 0.9848078;  // cos 10 degrees
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const TriangleMesh& mesh = solid.mesh;
  const auto normal_of = [&](std::int32_t triangle) -> Vec3 {
    const auto [a, b, c] = cornersOf(mesh, mesh.triangles[static_cast<std::size_t>(triangle)]);
    return (b - a).cross(c - a);
  };
  std::vector<double> area_up_to(mesh.triangles.size());
  double area = 0;
  for (std::size_t i = 0; i < area_up_to.size(); ++i) {
    area += normal_of(static_cast<std::int32_t>(i)).norm();
    area_up_to[i] = area;
  }
  std::vector<double> thickness_m(kRays, kNone);
  inParallel(kRays / kChunk + 1, threads, [&](std::size_t chunk) {
    std::vector<TriangleTree::Hit> hits;
    for (std::size_t ray = chunk * kChunk; ray < std::min(kRays, (chunk + 1) * kChunk); ++ray) {
      const double want = (static_cast<double>(ray) + 0.5) / static_cast<double>(kRays) * area;
      const auto triangle = static_cast<std::int32_t>(std::min<std::ptrdiff_t>(
          std::ranges::lower_bound(area_up_to, want) - area_up_to.begin(), std::ssize(area_up_to) - 1));
      // Kronecker's sequence of Roberts' R2: large triangles get their rays evenly.
      constexpr double kG1 = 0.7548776662466927;
      constexpr double kG2 = 0.5698402909980532;
      double u = std::fmod(kG1 * static_cast<double>(ray + 1), 1.0);
      double v = std::fmod(kG2 * static_cast<double>(ray + 1), 1.0);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const auto [a, b, c] = cornersOf(mesh, mesh.triangles[static_cast<std::size_t>(triangle)]);
      const Vec3 inwards = -normal_of(triangle).normalized();
      tree.hits(a + u * (b - a) + v * (c - a) + kBeside_m * inwards, inwards, hits);
      int winding = 0;
      for (const TriangleTree::Hit& hit : hits) {
        winding += normal_of(hit.triangle).dot(inwards) > 0 ? 1 : -1;
      }
      if (winding != 1) {
        continue;  // inside another part, or past an edge
      }
      std::ranges::sort(hits, {}, &TriangleTree::Hit::distance_m);
      for (const TriangleTree::Hit& hit : hits) {
        const Vec3 normal = normal_of(hit.triangle);
        winding += normal.dot(inwards) > 0 ? -1 : 1;
        if (winding <= 0) {
          if (normal.dot(inwards) >= kParallel * normal.norm()) {
            thickness_m[ray] = hit.distance_m + kBeside_m;
          }
          break;
        }
      }
    }
  });
  const auto thinnest = thickness_m.begin() + static_cast<std::ptrdiff_t>(kCounts * static_cast<double>(kRays));
  std::ranges::nth_element(thickness_m, thinnest);
  return *thinnest;
}

}  // namespace haptolith
