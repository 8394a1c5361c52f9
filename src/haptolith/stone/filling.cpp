#include "haptolith/stone/filling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "haptolith/core/math/portable_math.h"

namespace haptolith {

namespace {

/// A sphere may come through the surface by this part of the solid's size when it is looked for, and is made smaller
/// afterwards: where triangles stand for a curved surface, points near their edges would have tiny spheres only.
constexpr double kThrough = 0.003;
/// Spheres overlap when they do by this part of the smaller one's radius.
constexpr double kOverlap = 0.1;

/// The largest sphere inside that touches the surface at a point or nearly does; radius 0 without one. Spheres
/// that touch one point are nested, so that bisection finds it.
StoneSphere largestAt(const SurfacePoint& at, const DepthInSolid& depth, const FillingOptions& options) {
  const double through_m = kThrough * options.size_m;
  const auto fits = [&](double radius_m) {
    const double within_m = radius_m - through_m;
    return within_m <= 0 || depth(at.point_m + radius_m * at.inward, within_m) >= within_m;
  };
  double fits_m = 0;
  double too_large_m = options.largest_radius_m;
  while (too_large_m - fits_m > through_m / 4) {
    const double middle_m = (fits_m + too_large_m) / 2;
    (fits(middle_m) ? fits_m : too_large_m) = middle_m;
  }
  const Vec3 centre_m = at.point_m + fits_m * at.inward;
  return {.centre_m = centre_m, .radius_m = std::max(0.0, depth(centre_m, options.largest_radius_m))};
}

bool overlap(const StoneSphere& a, const StoneSphere& b) {
  const double near_m = a.radius_m + b.radius_m - kOverlap * std::min(a.radius_m, b.radius_m);
  return (a.centre_m - b.centre_m).squaredNorm() < near_m * near_m;
}

/// Chooses some of many spheres, one after the other.
class Choice {
 public:
  Choice(const std::vector<SurfacePoint>& surface, const std::vector<StoneSphere>& candidates)
      : surface_(surface),
        candidates_(candidates),
        most_gain_m2_(candidates.size(), kInfinity),
        known_at_(candidates.size(), 0),
        reached_(candidates.size(), false),
        away_m_(surface.size(), kInfinity) {}

  void take(const StoneSphere& sphere) {
    chosen_.push_back(sphere);
    for (std::size_t i = 0; i < surface_.size(); ++i) {
      const double distance_m = (surface_[i].point_m - sphere.centre_m).norm();
      away_m_[i] = std::min(away_m_[i], std::max(0.0, distance_m - sphere.radius_m));
    }
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      reached_[i] = reached_[i] || overlap(candidates_[i], sphere);
    }
  }

  /// The one that brings most of those that overlap the union; nullptr when none brings anything.
  const StoneSphere* best() {
    for (;;) {
      std::size_t best = candidates_.size();
      double most_m2 = 0;
      for (std::size_t i = 0; i < candidates_.size(); ++i) {
        if (reached_[i] && most_gain_m2_[i] > most_m2) {
          most_m2 = most_gain_m2_[i];
          best = i;
        }
      }
      if (best == candidates_.size()) {
        return nullptr;
      }
      if (known_at_[best] == chosen_.size()) {
        return &candidates_[best];
      }
      most_gain_m2_[best] = gain(candidates_[best]);
      known_at_[best] = chosen_.size();
    }
  }

  /// Part of the surface that is as near to the union.
  [[nodiscard]] double filled(double near_m) const {
    return static_cast<double>(std::ranges::count_if(away_m_, [&](double away_m) { return away_m <= near_m; })) /
           static_cast<double>(away_m_.size());
  }

  [[nodiscard]] std::vector<StoneSphere> chosen() && { return std::move(chosen_); }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  /// By how much a sphere lessens the sum of squared distances, in m^2.
  [[nodiscard]] double gain(const StoneSphere& sphere) const {
    double sum_m2 = 0;
    for (std::size_t i = 0; i < surface_.size(); ++i) {
      const double before_m = away_m_[i];
      const double reach_m = before_m + sphere.radius_m;
      const double squared_m2 = (surface_[i].point_m - sphere.centre_m).squaredNorm();
      if (before_m > 0 && squared_m2 < reach_m * reach_m) {
        const double after_m = std::max(0.0, std::sqrt(squared_m2) - sphere.radius_m);
        sum_m2 += before_m * before_m - after_m * after_m;
      }
    }
    return sum_m2;
  }

  const std::vector<SurfacePoint>& surface_;
  const std::vector<StoneSphere>& candidates_;
  std::vector<double> most_gain_m2_;   // upper bound per candidate: the more spheres, the less another adds
  std::vector<std::size_t> known_at_;  // number of spheres at that time
  std::vector<bool> reached_;          // overlaps one of the spheres
  std::vector<StoneSphere> chosen_;
  std::vector<double> away_m_;  // distance of each surface point from the union
};

}  // namespace

std::vector<SurfacePoint> spreadOver(const TriangleMesh& surface, std::size_t count) {
  const auto doubled_area = [&](std::size_t triangle) -> Vec3 {
    const auto [a, b, c] = cornersOf(surface, surface.triangles[triangle]);
    return (b - a).cross(c - a);
  };
  std::vector<double> area_up_to(surface.triangles.size());
  double area = 0;
  for (std::size_t i = 0; i < area_up_to.size(); ++i) {
    area += doubled_area(i).norm();
    area_up_to[i] = area;
  }
  std::vector<SurfacePoint> points;
  if (!(area > 0)) {
    return points;
  }
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double want = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * area;
    const auto triangle = static_cast<std::size_t>(std::min<std::ptrdiff_t>(
        std::ranges::lower_bound(area_up_to, want) - area_up_to.begin(), std::ssize(area_up_to) - 1));
    // Kronecker's sequence of Roberts' R2: large triangles get their points evenly.
    constexpr double kG1 = 0.7548776662466927;
    constexpr double kG2 = 0.5698402909980532;
    double u = std::fmod(kG1 * static_cast<double>(i + 1), 1.0);
    double v = std::fmod(kG2 * static_cast<double>(i + 1), 1.0);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const auto [a, b, c] = cornersOf(surface, surface.triangles[triangle]);
    points.push_back({.point_m = a + u * (b - a) + v * (c - a), .inward = -doubled_area(triangle).normalized()});
  }
  return points;
}

std::vector<StoneSphere> fillWithSpheres(const std::vector<SurfacePoint>& surface, const DepthInSolid& depth,
                                         const FillingOptions& options) {
  std::vector<StoneSphere> candidates;
  candidates.reserve(surface.size());
  for (const SurfacePoint& point : surface) {
    const StoneSphere sphere = largestAt(point, depth, options);
    if (sphere.radius_m > 0) {
      candidates.push_back(sphere);
    }
  }
  if (candidates.empty()) {
    return {};
  }
  Choice choice(surface, candidates);
  choice.take(*std::ranges::max_element(candidates, {}, &StoneSphere::radius_m));
  for (std::size_t i = 1; i < options.most_spheres && choice.filled(options.near_m) < options.filled; ++i) {
    const StoneSphere* best = choice.best();
    if (best == nullptr) {
      break;
    }
    choice.take(*best);
  }
  return std::move(choice).chosen();
}

StoneShape scaledTo(StoneShape stone, double size_m) {
  const double larger = size_m / 2 / stone.radius();
  for (StoneSphere& sphere : stone.spheres) {
    sphere.centre_m *= larger;
    sphere.radius_m *= larger;
  }
  for (Vec3& point_m : stone.shown.points_m) {
    point_m *= larger;
  }
  stone.volume_m3 *= portable::cube(larger);
  stone.inertia_m5 *= portable::cube(larger) * larger * larger;
  stone.reach_m *= larger;
  return stone;
}

}  // namespace haptolith
