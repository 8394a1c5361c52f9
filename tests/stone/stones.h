#pragma once

// Independent measurements for tests of stones.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/math/random.h"
#include "haptolith/stone/stone_shape.h"

namespace haptolith::made {

inline double distanceToUnion(const Vec3& point_m, const std::vector<StoneSphere>& spheres) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const StoneSphere& sphere : spheres) {
    least_m = std::min(least_m, (point_m - sphere.centre_m).norm() - sphere.radius_m);
  }
  return least_m;
}

/// Integrals over a union of spheres, by random points.
struct RandomMoments {
  double volume_m3 = 0;
  Vec3 centre_m = Vec3::Zero();
  Eigen::Matrix3d inertia_m5 = Eigen::Matrix3d::Zero();  ///< about the frame's origin
};

inline RandomMoments randomMoments(const std::vector<StoneSphere>& spheres, int points = 1'000'000) {
  Vec3 low_m = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high_m = -low_m;
  for (const StoneSphere& sphere : spheres) {
    low_m = low_m.cwiseMin(sphere.centre_m - Vec3::Constant(sphere.radius_m));
    high_m = high_m.cwiseMax(sphere.centre_m + Vec3::Constant(sphere.radius_m));
  }
  std::mt19937_64 random(7);
  const double share_m3 = (high_m - low_m).prod() / points;
  RandomMoments moments;
  for (int i = 0; i < points; ++i) {
    Vec3 point_m = (low_m + high_m) / 2;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      point_m[axis] += uniformSigned(random) * (high_m[axis] - low_m[axis]) / 2;
    }
    if (distanceToUnion(point_m, spheres) < 0) {
      moments.volume_m3 += share_m3;
      moments.centre_m += share_m3 * point_m;
      moments.inertia_m5 +=
          share_m3 * (point_m.squaredNorm() * Eigen::Matrix3d::Identity() - point_m * point_m.transpose());
    }
  }
  moments.centre_m /= moments.volume_m3;
  return moments;
}

/// The frame of a stone is what it says, within a part `error` of its size.
inline void expectPrincipalFrame(const StoneShape& stone, double error) {
  const RandomMoments moments = randomMoments(stone.spheres);
  EXPECT_NEAR(moments.volume_m3, stone.volume_m3, error * stone.volume_m3);
  EXPECT_LT(moments.centre_m.norm(), error * stone.radius());
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index column = 0; column < 3; ++column) {
      EXPECT_NEAR(moments.inertia_m5(row, column), row == column ? stone.inertia_m5[row] : 0,
                  error * stone.inertia_m5.maxCoeff());
    }
  }
}

inline std::string refusalOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace haptolith::made
