#include "haptolith/core/movement.h"

#include <gtest/gtest.h>

#include <numbers>

#include "haptolith/core/ramp.h"

namespace haptolith {
namespace {

TEST(Movement, ARotationVectorTurnsAndIsFoundAgain) {
  const Vec3 axis = Vec3(1, -2, 3).normalized();
  const Quat from(Eigen::AngleAxisd(0.7, Vec3(0, 1, 1).normalized()));
  for (const double angle_rad : {0.0, 1e-9, 0.5, 3.0}) {
    EXPECT_LT((rotationBetween(from, turnedBy(angle_rad * axis, from)) - angle_rad * axis).norm(), 1e-7) << angle_rad;
  }
  // The short way round.
  const Vec3 back = rotationBetween(from, turnedBy((2 * std::numbers::pi - 0.5) * axis, from));
  EXPECT_LT((back + 0.5 * axis).norm(), 1e-9);
}

TEST(Movement, AVectorIsShortenedAndKeepsItsDirection) {
  EXPECT_EQ(atMost(5, Vec3(3, 4, 0)), Vec3(3, 4, 0));
  EXPECT_LT((atMost(1, Vec3(3, 4, 0)) - Vec3(0.6, 0.8, 0)).norm(), 1e-15);
  EXPECT_EQ(atMost(0, Vec3::Zero()), Vec3::Zero());
}

TEST(Ramp, RisesAndFallsEvenlyAndStaysBetweenNothingAndAll) {
  Ramp ramp(0);
  for (int tick = 0; tick < 100; ++tick) {
    ramp.rise(1e-3, 0.2);
  }
  EXPECT_NEAR(ramp.share(), 0.5, 1e-12);
  for (int tick = 0; tick < 200; ++tick) {
    ramp.rise(1e-3, 0.2);
  }
  EXPECT_EQ(ramp.share(), 1);
  ramp.fall(1e-3, 0.01);
  EXPECT_NEAR(ramp.share(), 0.9, 1e-12);
  ramp.fall(1, 0.01);
  EXPECT_EQ(ramp.share(), 0);
}

}  // namespace
}  // namespace haptolith
