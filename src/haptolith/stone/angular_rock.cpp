#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "haptolith/core/math/portable_math.h"
#include "haptolith/core/math/random.h"
#include "haptolith/stone/filling.h"
#include "haptolith/stone/stone_shape.h"

namespace haptolith {

namespace {

// A rock is made about one unit of length large, and scaled in the end.

/// Shape parameters of broken rock, found by visual comparison.
struct RockLook {
  static constexpr int kFewestFaces = 14;
  static constexpr int kMoreFaces = 6;          ///< up to this number in addition
  static constexpr double kNearestFace = 0.74;  ///< distance from the centre, over the radius of the sphere that is cut
  static constexpr double kFarthestFace = 1.06;
  static constexpr int kDirections = 6;  ///< drawn for each face: the one that is farthest from those before it counts
  static constexpr double kShortestEdge = 0.12;  ///< a cut that would leave a shorter one is drawn again
  static constexpr int kTries = 60;
  static constexpr double kUneven = 0.12;  ///< part by which axes differ from the usual
};
const Vec3 kAxes{1.25, 1, 0.8};

constexpr std::size_t kSurfacePoints = 1000;
constexpr double kNear = 0.015;  // fraction of the size
constexpr std::size_t kMostSpheres = 45;

/// A convex body about the origin.
class Polyhedron {
 public:
  /// A cube with edges of 2 `half`.
  explicit Polyhedron(double half) {
    for (int corner = 0; corner < 8; ++corner) {
      points_.emplace_back((corner & 1) != 0 ? half : -half, (corner & 2) != 0 ? half : -half,
                           (corner & 4) != 0 ? half : -half);
    }
    faces_ = {{{0, 4, 6, 2}, -Vec3::UnitX(), half}, {{1, 3, 7, 5}, Vec3::UnitX(), half},
              {{0, 1, 5, 4}, -Vec3::UnitY(), half}, {{2, 6, 7, 3}, Vec3::UnitY(), half},
              {{0, 2, 3, 1}, -Vec3::UnitZ(), half}, {{4, 5, 7, 6}, Vec3::UnitZ(), half}};
  }

  /// Takes away what lies beyond a plane; false when that is nothing.
  bool cut(const Vec3& normal, double distance) {
    const auto beyond = [&](std::int32_t i) { return height(i, normal) > distance; };
    std::vector<Face> left;
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> cut_edges;
    const auto point_on = [&](std::int32_t a, std::int32_t b) {
      const auto [found, is_new] = cut_edges.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(points_.size()));
      if (is_new) {
        const auto [from, to] = found->first;
        const double part = (distance - height(from, normal)) / (height(to, normal) - height(from, normal));
        const Vec3 point = at(from) + part * (at(to) - at(from));
        points_.push_back(point);
      }
      return found->second;
    };
    std::map<std::int32_t, std::int32_t> next;  // around the new face
    for (const Face& face : faces_) {
      Face rest{.around = {}, .normal = face.normal, .distance = face.distance};
      std::int32_t leaves = -1;
      std::int32_t enters = -1;
      for (std::size_t i = 0; i < face.around.size(); ++i) {
        const std::int32_t from = face.around[i];
        const std::int32_t to = face.around[(i + 1) % face.around.size()];
        if (!beyond(from)) {
          rest.around.push_back(from);
        }
        if (beyond(from) != beyond(to)) {
          const std::int32_t on = point_on(from, to);
          rest.around.push_back(on);
          (beyond(to) ? leaves : enters) = on;
        }
      }
      if (leaves >= 0) {
        next[enters] = leaves;  // the face goes the other way along their edge
      }
      if (!rest.around.empty()) {
        left.push_back(std::move(rest));
      }
    }
    if (next.empty()) {
      return false;
    }
    Face face{.around = {}, .normal = normal, .distance = distance};
    const std::int32_t first = next.begin()->first;
    std::int32_t on = first;
    do {
      face.around.push_back(on);
      on = next.at(on);
    } while (on != first);
    left.push_back(std::move(face));
    faces_ = std::move(left);
    return true;
  }

  [[nodiscard]] double shortestEdge() const {
    double shortest = std::numeric_limits<double>::infinity();
    for (const Face& face : faces_) {
      for (std::size_t i = 0; i < face.around.size(); ++i) {
        shortest = std::min(shortest, (at(face.around[i]) - at(face.around[(i + 1) % face.around.size()])).norm());
      }
    }
    return shortest;
  }

  void stretch(const Vec3& by) {
    for (Vec3& point : points_) {
      point = point.cwiseProduct(by);
    }
    for (Face& face : faces_) {
      const Vec3 normal = face.normal.cwiseQuotient(by);
      face.normal = normal.normalized();
      face.distance /= normal.norm();
    }
  }

  /// Distance from a point inside to the nearest face; negative outside.
  [[nodiscard]] double depth(const Vec3& point) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Face& face : faces_) {
      nearest = std::min(nearest, face.distance - face.normal.dot(point));
    }
    return nearest;
  }

  [[nodiscard]] TriangleMesh mesh() const {
    TriangleMesh mesh;
    std::map<std::int32_t, std::int32_t> used;
    const auto index = [&](std::int32_t i) {
      const auto [found, is_new] = used.try_emplace(i, static_cast<std::int32_t>(mesh.points_m.size()));
      if (is_new) {
        mesh.points_m.push_back(at(i));
      }
      return found->second;
    };
    for (const Face& face : faces_) {
      for (std::size_t i = 2; i < face.around.size(); ++i) {
        const std::int32_t a = index(face.around[0]);
        const std::int32_t b = index(face.around[i - 1]);
        const std::int32_t c = index(face.around[i]);
        mesh.triangles.push_back({a, b, c});
      }
    }
    return mesh;
  }

 private:
  struct Face {
    std::vector<std::int32_t> around;  // counter-clockwise from outside
    Vec3 normal;
    double distance;  // from the origin
  };

  [[nodiscard]] const Vec3& at(std::int32_t i) const { return points_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] double height(std::int32_t i, const Vec3& normal) const { return normal.dot(at(i)); }

  std::vector<Vec3> points_;  // also those that were cut away
  std::vector<Face> faces_;
};

/// Any direction, as likely as any other.
Vec3 randomDirection(std::mt19937_64& random) {
  for (;;) {
    const double x = uniformSigned(random);
    const double y = uniformSigned(random);
    const double z = uniformSigned(random);
    const Vec3 point(x, y, z);
    const double norm = point.norm();
    if (norm > 0.1 && norm < 1) {
      return point / norm;
    }
  }
}

Polyhedron brokenRock(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto between = [&](double low, double high) { return low + (high - low) * (uniformSigned(random) + 1) / 2; };
  constexpr double kBeyondAll = 10;
  Polyhedron rock(kBeyondAll);
  std::vector<Vec3> normals;
  const auto wanted =
      static_cast<std::size_t>(between(RockLook::kFewestFaces, RockLook::kFewestFaces + RockLook::kMoreFaces + 1));
  for (int tries = 0; tries < RockLook::kTries && normals.size() < wanted; ++tries) {
    Vec3 normal = Vec3::UnitZ();
    double least_near = 2;
    for (int i = 0; i < RockLook::kDirections; ++i) {
      const Vec3 direction = randomDirection(random);
      double nearest = -1;
      for (const Vec3& other : normals) {
        nearest = std::max(nearest, direction.dot(other));
      }
      if (nearest < least_near) {
        least_near = nearest;
        normal = direction;
      }
    }
    Polyhedron cut = rock;
    if (cut.cut(normal, between(RockLook::kNearestFace, RockLook::kFarthestFace)) &&
        cut.shortestEdge() > RockLook::kShortestEdge) {
      rock = std::move(cut);
      normals.push_back(normal);
    }
  }
  Vec3 axes = kAxes;
  for (double& axis : axes) {
    axis *= 1 + RockLook::kUneven * uniformSigned(random);
  }
  rock.stretch(axes);
  return rock;
}

}  // namespace

StoneShape angularRock(double size_m, std::uint64_t seed) {
  requireInRange("size_m", size_m, kStoneSize_m);
  const Polyhedron rock = brokenRock(seed);
  TriangleMesh mesh = rock.mesh();
  double volume = 0;
  double largest = 0;
  for (const auto& triangle : mesh.triangles) {
    const auto [a, b, c] = cornersOf(mesh, triangle);
    volume += a.dot(b.cross(c)) / 6;
  }
  for (const Vec3& point : mesh.points_m) {
    largest = std::max(largest, point.norm());
  }
  const double size = portable::cbrt(6 * volume / std::numbers::pi);
  const DepthInSolid depth = [&](const Vec3& point, double most) { return std::min(most, rock.depth(point)); };
  std::vector<StoneSphere> spheres = fillWithSpheres(
      spreadOver(mesh, kSurfacePoints), depth,
      {.size_m = size, .near_m = kNear * size, .largest_radius_m = largest, .most_spheres = kMostSpheres});
  return scaledTo(makeStoneShape(std::move(spheres), std::move(mesh)), size_m);
}

}  // namespace haptolith
