#include "haptolith/identify/tool_cut.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace haptolith {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kDepth_m = 0.02;

/// A shovel of 50 mm by 40 mm by 5 mm whose lowest point is so deep, turned about y.
Pose shovelAt(double turn_rad, double depth_m) {
  const double half_m = (0.05 * std::abs(std::sin(turn_rad)) + 0.005 * std::abs(std::cos(turn_rad))) / 2;
  return {{0, 0, half_m - depth_m}, Quat(Eigen::AngleAxisd(turn_rad, Vec3::UnitY()))};
}

ToolSurface shovel() {
  ToolParameters tool;
  tool.size_m = {0.05, 0.04, 0.005};
  return toolSurface(tool, 0);
}

TEST(ToolCut, AnUprightBladeStandsAtNinetyDegrees) {
  const auto cut = cutOf(shovel(), shovelAt(90 * kDegree, kDepth_m), {0.03, 0, 0});
  ASSERT_TRUE(cut);
  EXPECT_NEAR(cut->depth_m, kDepth_m, 1e-12);
  EXPECT_NEAR(cut->rake_rad, 90 * kDegree, 1e-9);
  EXPECT_LT((cut->ahead - Vec3::UnitX()).norm(), 1e-12);
}

TEST(ToolCut, ABladeThatLeansBackIsFlatterWhicheverWayItGoes) {
  for (const double way : {0.0, 1.0, 2.5, 4.0}) {
    const Quat turned(Eigen::AngleAxisd(way, Vec3::UnitZ()));
    Pose pose = shovelAt(60 * kDegree, kDepth_m);
    pose.orientation = turned * pose.orientation;
    const auto cut = cutOf(shovel(), pose, turned * Vec3(0.03, 0, 0));
    ASSERT_TRUE(cut);
    // Its thin lower edge also leads: 5 mm against 50.
    EXPECT_NEAR(cut->rake_rad, 60 * kDegree, 4 * kDegree);
    EXPECT_LT((cut->ahead - turned * Vec3::UnitX()).norm(), 1e-12);
  }
}

TEST(ToolCut, APlateThatIsPressedLiesFlat) {
  const auto cut = cutOf(shovel(), shovelAt(0, kDepth_m), {0, 0, -0.015});
  ASSERT_TRUE(cut);
  EXPECT_NEAR(cut->rake_rad, 180 * kDegree, 1e-9);
}

TEST(ToolCut, ThereIsNoneInTheAirStandingStillOrOnTheWayOut) {
  const Pose in_soil = shovelAt(90 * kDegree, kDepth_m);
  EXPECT_FALSE(cutOf(shovel(), shovelAt(90 * kDegree, 0.9 * kLeastDepth_m), {0.03, 0, 0}));
  EXPECT_FALSE(cutOf(shovel(), in_soil, Vec3::Zero()));
  EXPECT_FALSE(cutOf(shovel(), in_soil, {0.001, 0, 0}));
  EXPECT_FALSE(cutOf(shovel(), in_soil, {0, 0, 0.03}));
  EXPECT_FALSE(cutOf(shovel(), in_soil, {0.03, 0, 0.02}));
  EXPECT_FALSE(cutOf(shovel(), in_soil, {std::nan(""), 0, 0}));
}

}  // namespace
}  // namespace haptolith
