#include "haptolith/teleop/robot/bilateral_end.h"

#include <gtest/gtest.h>

#include <random>

#include "haptolith/core/math/random.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;

Vec3 anything(std::mt19937_64& random, double size) {
  const double x = uniformSigned(random);
  const double y = uniformSigned(random);
  return size * Vec3(x, y, uniformSigned(random));
}

double power(const Wrench& wrench, const Twist& twist) {
  return wrench.force_n.dot(twist.linear_m_s) + wrench.torque_nm.dot(twist.angular_rad_s);
}

TEST(BilateralEnd, NeverGivesAHandMoreThanItHasBeenTold) {
  std::mt19937_64 random(1);
  BilateralEnd end(kTick_s, 0.1);
  double told_j = 0, out_j = 0, in_j = 0;
  for (int tick = 0; tick < 20000; ++tick) {
    told_j += 1e-5 * (1 + uniformSigned(random));
    end.hear(told_j);
    const Wrench wanted{anything(random, 5), anything(random, 0.1)};
    const Twist twist{anything(random, 0.3), anything(random, 2)};
    const double work_j = kTick_s * power(end.damp(wanted, twist), twist);
    (work_j > 0 ? out_j : in_j) += std::abs(work_j);
    ASSERT_LE(out_j, told_j + 1e-12) << tick;
  }
  EXPECT_NEAR(end.in(), in_j, 1e-9);
  EXPECT_GT(end.dissipated(), 0.1 * told_j) << "else nothing was asked of it";
}

TEST(BilateralEnd, NeverMovesARobotWithMoreThanItHasBeenTold) {
  std::mt19937_64 random(2);
  BilateralEnd end(kTick_s, 0.1);
  double told_j = 0, out_j = 0;
  for (int tick = 0; tick < 20000; ++tick) {
    told_j += 1e-5 * (1 + uniformSigned(random));
    end.hear(told_j);
    const Twist wanted{anything(random, 0.3), anything(random, 2)};
    const Wrench load{anything(random, 5), anything(random, 0.1)};
    out_j += std::max(0.0, -kTick_s * power(load, end.brake(wanted, load)));
    ASSERT_LE(out_j, told_j + 1e-12) << tick;
  }
}

TEST(BilateralEnd, LeavesAloneWhatIsPaidFor) {
  BilateralEnd end(kTick_s, 0.1);
  end.hear(1);
  const Wrench pushes{{1, 0, 0}, Vec3::Zero()};
  const Twist away{{0.1, 0, 0}, Vec3::Zero()};
  EXPECT_EQ(end.damp(pushes, away).force_n, pushes.force_n);
  EXPECT_NEAR(end.margin(), 1 - 1e-4, 1e-15);
  const Wrench resists{{-1, 0, 0}, Vec3::Zero()};
  EXPECT_EQ(end.damp(resists, away).force_n, resists.force_n) << "a hand that pushes against it pays";
  EXPECT_NEAR(end.in(), 1e-4, 1e-15);
}

TEST(BilateralEnd, OldNewsTakesNothingBack) {
  BilateralEnd end(kTick_s, 0.1);
  end.hear(2);
  end.hear(1);
  EXPECT_EQ(end.margin(), 2);
}

}  // namespace
}  // namespace haptolith
