#include "haptolith/tool/mesh_contact.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "haptolith/core/assert.h"

namespace haptolith {

namespace {

constexpr int kDirections = 15;  // along an edge of the unfolded octahedron

/// Code of a direction for Penetration::side.
int sideOf(const Vec3& outward) {
  return static_cast<std::int8_t>(directionCode(outward));
}

double signOf(double value) {
  return value < 0 ? -1 : 1;
}

/// A direction by which a surface may turn from one call to the next and still be the same side, as its cosine: more
/// than around an edge, less than through a wall.
constexpr double kSameSide = 0.2;

/// Finds the end of the body from `from_m` along a unit vector, inside it or behind it; empty if none within
/// `longest_m`.
std::optional<Vec3> wayOut(const DistanceField& field, const Vec3& from_m, const Vec3& along, double longest_m) {
  HAPTO_ASSERT(field.spacing() > 0);
  HAPTO_ASSERT(longest_m >= 0);
  const double shortest_m = field.spacing() / 2;
  bool inside = false;
  double before_m = 0, distance_before_m = 0;
  for (double way_m = 0; way_m <= longest_m;) {
    const double distance_m = field.at(from_m + way_m * along).distance_m;
    if (way_m == 0 && distance_m == 0) {
      return from_m;
    }
    if (inside && distance_m >= 0) {  // between the two the field is as good as straight
      const double share = distance_before_m / (distance_before_m - distance_m);
      return from_m + (before_m + share * (way_m - before_m)) * along;
    }
    inside = distance_m < 0;
    before_m = way_m;
    distance_before_m = distance_m;
    way_m += std::max(std::abs(distance_m), shortest_m);
  }
  return std::nullopt;
}

/// Whether the body is still there on the other side of a point outside it: against a unit vector, within `longest_m`.
bool isStillBehind(const DistanceField& field, const Vec3& from_m, const Vec3& along, double longest_m) {
  HAPTO_ASSERT(field.spacing() > 0);
  const double shortest_m = field.spacing() / 2;
  for (double way_m = 0; way_m <= longest_m;) {
    const double distance_m = field.at(from_m - way_m * along).distance_m;
    if (distance_m < 0) {
      return true;
    }
    way_m += std::max(distance_m, shortest_m);
  }
  return false;
}

/// A sphere that touches where the surface is next to `surface_m`, which is on it.
Penetration touching(const DistanceField& field, const Vec3& centre_m, double radius_m, Vec3 surface_m) {
  // To the foot of the perpendicular from the centre, on the same side: once for flat walls, twice for round ones.
  constexpr int kTimes = 2;
  Vec3 outward = field.at(surface_m).gradient;
  for (int i = 0; i < kTimes; ++i) {
    surface_m = centre_m + (surface_m - centre_m).dot(outward) * outward;
    const DistanceField::Sample there = field.at(surface_m);
    surface_m -= there.distance_m * there.gradient;
    outward = there.gradient;
  }
  return {.depth_m = radius_m + (surface_m - centre_m).dot(outward), .outward = outward, .side = sideOf(outward)};
}

}  // namespace

int directionCode(const Vec3& direction) noexcept {
  const double sum = direction.cwiseAbs().sum();
  if (!(sum > 0)) {
    return 0;
  }
  double u = direction.x() / sum, v = direction.y() / sum;
  if (direction.z() < 0) {
    const double folded_u = (1 - std::abs(v)) * signOf(u);
    v = (1 - std::abs(u)) * signOf(v);
    u = folded_u;
  }
  const auto step = [](double x) {
    return std::clamp(static_cast<int>(std::lround((x + 1) / 2 * (kDirections - 1))), 0, kDirections - 1);
  };
  return 1 + step(u) * kDirections + step(v);
}

Vec3 directionOf(int code) noexcept {
  const auto along = [](int step) { return 2.0 * step / (kDirections - 1) - 1; };
  const double u = along((code - 1) / kDirections), v = along((code - 1) % kDirections);
  const double z = 1 - std::abs(u) - std::abs(v);
  const double folded = std::max(-z, 0.0);
  return Vec3(u - folded * signOf(u), v - folded * signOf(v), z).normalized();
}

Penetration meshPenetration(const DistanceField& field, const Vec3& centre_m, double radius_m, double letting_go_m,
                            int side) noexcept {
  const DistanceField::Sample here = field.at(centre_m);
  if (side != 0) {
    const Vec3 kept = directionOf(static_cast<std::uint8_t>(side));
    const bool same_side = here.distance_m >= 0 && here.gradient.dot(kept) > kSameSide;
    const bool passed_through = here.distance_m > radius_m;
    // Between two walls the other one may be nearer now, while the one that it touched is still where it was.
    const bool between = here.distance_m > 0 && isStillBehind(field, centre_m, kept, radius_m + letting_go_m);
    if (!same_side && !passed_through && !between) {
      if (const std::optional<Vec3> surface_m = wayOut(field, centre_m, kept, 2 * radius_m)) {
        return touching(field, centre_m, radius_m, *surface_m);
      }
      if (here.distance_m <= -field.band()) {  // deeper than is known: out the way it came in
        return {.depth_m = radius_m - here.distance_m, .outward = kept, .side = side};
      }
    }
  }
  Penetration nearest{.depth_m = radius_m - here.distance_m, .outward = here.gradient, .side = 0};
  if (nearest.depth_m >= -letting_go_m) {
    nearest.side = sideOf(nearest.outward);
  }
  return nearest;
}

}  // namespace haptolith
