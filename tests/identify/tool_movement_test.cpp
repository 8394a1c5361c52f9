#include "haptolith/identify/training/tool_movement.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "haptolith/identify/training/digging.h"

namespace haptolith {
namespace {

TEST(ToolMovement, GoesStraightFromPoseToPose) {
  const Quat turned(Eigen::AngleAxisd(1, Vec3::UnitY()));
  const ToolMovement movement({{0, {}}, {2, {{0.1, 0, 0}, turned}}});
  EXPECT_EQ(movement.at(-1).position_m, Vec3::Zero());
  EXPECT_NEAR(movement.at(0.5).position_m.x(), 0.025, 1e-15);
  EXPECT_NEAR(movement.at(1).orientation.angularDistance(Quat::Identity()), 0.5, 1e-12);
  EXPECT_NEAR(movement.at(9).position_m.x(), 0.1, 1e-15);
  EXPECT_EQ(movement.duration(), 2);
}

TEST(ToolMovement, RefusesTimesThatDoNotGrow) {
  for (const std::vector<double>& times : {std::vector<double>{}, {0}, {1, 2}, {0, 0}, {0, NAN}, {0, 2, 1}}) {
    std::vector<TimedPose> poses;
    for (const double time_s : times) {
      poses.push_back({time_s, {}});
    }
    EXPECT_THROW(ToolMovement{poses}, InvalidParameter) << times.size();
  }
}

/// The lowest of the shovel's corners.
double lowestPoint(const ToolParameters& shovel, const Pose& pose) {
  double lowest_m = 1;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
    lowest_m = std::min(lowest_m, pose.fromBody(shovel.size_m.cwiseProduct(sign) / 2).z());
  }
  return lowest_m;
}

TEST(Probe, StaysInItsFieldAndAtHandSpeed) {
  const ToolParameters shovel;
  const ToolMovement probe = probeMovement(shovel);
  const DiggingField field;
  double deepest_m = 0;
  for (double t = 0; t < probe.duration(); t += 0.01) {
    const Pose pose = probe.at(t);
    EXPECT_LT(std::abs(pose.position_m.x()) + 0.03, field.width_m / 2);
    EXPECT_LT(std::abs(pose.position_m.y()) + 0.02, field.length_m / 2);
    EXPECT_LT((probe.at(t + 0.01).position_m - pose.position_m).norm() / 0.01, 0.16) << "m/s at " << t << " s";
    deepest_m = std::min(deepest_m, lowestPoint(shovel, pose));
  }
  EXPECT_NEAR(deepest_m, -0.035, 1e-6) << "the lower edge of the deepest cut, as far as it says";
}

TEST(Probe, IsAShovelsAlone) {
  EXPECT_THROW((void)probeMovement({.shape = ToolShape::kSphere}), InvalidParameter);
  EXPECT_THROW((void)probeMovement({.size_m{0.2, 0.04, 0.005}}), InvalidParameter);
}

}  // namespace
}  // namespace haptolith
