#include "haptolith/core/vec.h"

#include <gmock/gmock.h>

#include <numbers>

namespace haptolith {
namespace {

// A quarter turn about z takes x to y and y to -x.
Quat quarterTurnAboutZ() {
  return Quat(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()));
}

TEST(Pose, TurnsThenMoves) {
  const Pose pose{Vec3(1, 2, 3), quarterTurnAboutZ()};
  EXPECT_TRUE(pose.fromBody(Vec3(10, 0, 0)).isApprox(Vec3(1, 12, 3)));
  EXPECT_TRUE(pose.fromBody(Vec3(0, 10, 1)).isApprox(Vec3(-9, 2, 4)));
}

TEST(Pose, GoesToTheBodyAndBack) {
  const Pose pose{Vec3(1, 2, 3), Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()))};
  const Vec3 point(0.3, -0.2, 0.9);
  EXPECT_TRUE(pose.toBody(pose.fromBody(point)).isApprox(point));
  EXPECT_TRUE(pose.fromBody(pose.toBody(point)).isApprox(point));
}

TEST(Twist, PointsFartherOutMoveFaster) {
  // 2 rad/s about z, half a metre along x: 1 m/s along y, on top of the body's own 3 m/s along x.
  const Twist twist{Vec3(3, 0, 0), Vec3(0, 0, 2)};
  EXPECT_TRUE(twist.at(Vec3(0.5, 0, 0)).isApprox(Vec3(3, 1, 0)));
}

TEST(Wrench, TakesTorqueFromTheLeverArm) {
  Wrench wrench;
  wrench.add(Vec3(0, 0, -10), Vec3(0.2, 0, 0));  // 10 N down, 20 cm along x: 2 N m about +y
  EXPECT_TRUE(wrench.force_n.isApprox(Vec3(0, 0, -10)));
  EXPECT_TRUE(wrench.torque_nm.isApprox(Vec3(0, 2, 0)));
  wrench.add(Vec3(0, 0, 10), Vec3(-0.2, 0, 0));  // a couple: the forces cancel, the torques add
  EXPECT_TRUE(wrench.force_n.isZero());
  EXPECT_TRUE(wrench.torque_nm.isApprox(Vec3(0, 4, 0)));
}

TEST(Wrench, FeelsNoTorqueFromAForceThroughTheOrigin) {
  Wrench wrench;
  wrench.add(Vec3(1, 2, 3), Vec3(2, 4, 6));
  EXPECT_TRUE(wrench.torque_nm.isZero());
}

}  // namespace
}  // namespace haptolith
