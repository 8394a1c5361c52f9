#include "haptolith/stone/stone_shape.h"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "haptolith/core/math/portable_math.h"

namespace haptolith {

namespace {

using Matrix3 = Eigen::Matrix3d;

/// Number of lines through the union in each of two directions.
constexpr int kLines = 128;

void require(const std::vector<StoneSphere>& spheres) {
  requireInRange("spheres", static_cast<double>(spheres.size()), {1, static_cast<double>(kMostStoneSpheres)});
  for (const StoneSphere& sphere : spheres) {
    requireInRange("radius_m", sphere.radius_m, {0, std::numeric_limits<double>::infinity(), Ends::kOpenBelow});
    for (const double coordinate_m : sphere.centre_m) {
      requireInRange("centre_m", coordinate_m, {});
    }
  }
  // From the first one to all that it overlaps, and on.
  std::vector<std::size_t> waiting{0};
  std::vector<bool> reached(spheres.size(), false);
  reached[0] = true;
  std::size_t together = 0;
  while (!waiting.empty()) {
    const StoneSphere& from = spheres[waiting.back()];
    waiting.pop_back();
    ++together;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      if (!reached[i] && (spheres[i].centre_m - from.centre_m).norm() < spheres[i].radius_m + from.radius_m) {
        reached[i] = true;
        waiting.push_back(i);
      }
    }
  }
  if (together < spheres.size()) {
    throw InvalidParameter("spheres", fmt::format("{} that hold together of {}", together, spheres.size()),
                           "spheres that all hold together: each overlaps another");
  }
}

/// Integrals over a body.
struct Moments {
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Matrix3 second = Matrix3::Zero();  // integral of x x^T
};

/// Moments of the union, with a unit of length near its size. Lines along x pass it through the centres of a grid's
/// cells in y and z; along each of them the sum is exact, and that of the lines nearly is, because the integrand is
/// smooth except at edges and rims.
Moments momentsOf(const std::vector<StoneSphere>& spheres) {
  Vec3 low = spheres.front().centre_m;
  Vec3 high = low;
  for (const StoneSphere& sphere : spheres) {
    low = low.cwiseMin(sphere.centre_m - Vec3::Constant(sphere.radius_m));
    high = high.cwiseMax(sphere.centre_m + Vec3::Constant(sphere.radius_m));
  }
  const Vec3 cell = (high - low) / kLines;
  Moments moments;
  std::vector<StoneSphere> passed;
  std::vector<std::pair<double, double>> inside;
  for (int k = 0; k < kLines; ++k) {
    const double z = low.z() + (k + 0.5) * cell.z();
    passed.clear();
    std::ranges::copy_if(spheres, std::back_inserter(passed), [&](const StoneSphere& sphere) {
      return std::abs(sphere.centre_m.z() - z) < sphere.radius_m;
    });
    for (int j = 0; j < kLines; ++j) {
      const double y = low.y() + (j + 0.5) * cell.y();
      inside.clear();
      for (const StoneSphere& sphere : passed) {
        const double half2 = sphere.radius_m * sphere.radius_m - portable::square(sphere.centre_m.y() - y) -
                             portable::square(sphere.centre_m.z() - z);
        if (half2 > 0) {
          inside.emplace_back(sphere.centre_m.x() - std::sqrt(half2), sphere.centre_m.x() + std::sqrt(half2));
        }
      }
      std::ranges::sort(inside);
      double end = -std::numeric_limits<double>::infinity();
      for (const auto& [from, to] : inside) {
        const double a = std::max(from, end);
        if (to <= a) {
          continue;
        }
        end = to;
        const double length = to - a;
        const double x = (to * to - a * a) / 2;
        moments.volume += length;
        moments.first += Vec3(x, length * y, length * z);
        Matrix3 second;
        second << (to * to * to - a * a * a) / 3, x * y, x * z,  //
            x * y, length * y * y, length * y * z,               //
            x * z, length * y * z, length * z * z;
        moments.second += second;
      }
    }
  }
  const double face = cell.y() * cell.z();
  return {moments.volume * face, moments.first * face, moments.second * face};
}

/// Unit vectors along the principal axes as columns, the smallest moment first, and right-handed. An axis has no
/// sign: the first two point to where their largest coordinate is above 0.
Matrix3 principalAxes(const Matrix3& inertia) {
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(inertia);
  Matrix3 axes = solver.eigenvectors();
  for (Eigen::Index i = 0; i < 2; ++i) {
    Eigen::Index largest = 0;
    axes.col(i).cwiseAbs().maxCoeff(&largest);
    if (axes(largest, i) < 0) {
      axes.col(i) *= -1;
    }
  }
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

double ballVolume(double radius_m) {
  return 4.0 / 3 * std::numbers::pi * portable::cube(radius_m);
}

}  // namespace

double StoneShape::radius() const noexcept {
  return portable::cbrt(volume_m3 * 3 / (4 * std::numbers::pi));
}

StoneShape makeStoneShape(std::vector<StoneSphere> spheres, TriangleMesh shown) {
  require(spheres);
  StoneShape stone;
  Vec3 centre_m = spheres.front().centre_m;
  Matrix3 axes = Matrix3::Identity();
  if (spheres.size() == 1) {
    const double radius_m = spheres.front().radius_m;
    stone.volume_m3 = ballVolume(radius_m);
    stone.inertia_m5 = Vec3::Constant(0.4 * stone.volume_m3 * radius_m * radius_m);
  } else {
    // About the first centre, where a stone far from the origin has lost no digits.
    const Vec3 from_m = centre_m;
    for (StoneSphere& sphere : spheres) {
      sphere.centre_m -= from_m;
    }
    for (Vec3& point_m : shown.points_m) {
      point_m -= from_m;
    }
    const Moments moments = momentsOf(spheres);
    centre_m = moments.first / moments.volume;
    const Matrix3 spread = moments.second - moments.volume * centre_m * centre_m.transpose();
    const Matrix3 inertia = spread.trace() * Matrix3::Identity() - spread;
    axes = principalAxes(inertia);
    stone.volume_m3 = moments.volume;
    stone.inertia_m5 = (axes.transpose() * inertia * axes).diagonal();
  }
  const auto to_stone = [&](const Vec3& point_m) -> Vec3 { return axes.transpose() * (point_m - centre_m); };
  for (StoneSphere& sphere : spheres) {
    sphere.centre_m = to_stone(sphere.centre_m);
    stone.reach_m = std::max(stone.reach_m, sphere.centre_m.norm() + sphere.radius_m);
  }
  for (Vec3& point_m : shown.points_m) {
    point_m = to_stone(point_m);
  }
  stone.spheres = std::move(spheres);
  stone.shown = std::move(shown);
  return stone;
}

StoneShape roundStone(double size_m) {
  requireInRange("size_m", size_m, kStoneSize_m);
  return makeStoneShape({{.centre_m = Vec3::Zero(), .radius_m = size_m / 2}});
}

}  // namespace haptolith
