#include "haptolith/haptics/coupling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;
constexpr double kCutoff_hz = 30;
const Eigen::Matrix3d kNoStiffness = Eigen::Matrix3d::Zero();

CouplingParameters virtualOne() {
  CouplingParameters coupling;
  coupling.kind = CouplingKind::kVirtual;
  coupling.spring = {.mass_kg = 0.3, .damping_n_s_m = 19, .stiffness_n_m = 300, .lever_m = 0.1};
  return coupling;
}

HandState at(const Vec3& position_m, const Vec3& velocity_m_s = Vec3::Zero()) {
  HandState movement;
  movement.pose.position_m = position_m;
  movement.twist.linear_m_s = velocity_m_s;
  return movement;
}

/// Soil as a wall at z = 0, far stiffer than the coupling's spring.
Wrench wall(const Movement& tool, double stiffness_n_m) {
  return {Vec3(0, 0,
               std::max(0.0, -stiffness_n_m * tool.pose.position_m.z() - 20 * tool.twist.linear_m_s.z()) *
                   (tool.pose.position_m.z() < 0 ? 1 : 0)),
          Vec3::Zero()};
}

TEST(Coupling, AutoIsDirectForADeviceThatShowsForceAndVirtualForOneThatDoesNot) {
  EXPECT_FALSE(Coupling({}, true, kCutoff_hz, kTick_s).isVirtual());
  EXPECT_TRUE(Coupling({}, false, kCutoff_hz, kTick_s).isVirtual());
  for (const bool shows_force : {true, false}) {
    CouplingParameters parameters;
    parameters.kind = CouplingKind::kDirect;
    EXPECT_FALSE(Coupling(parameters, shows_force, kCutoff_hz, kTick_s).isVirtual());
    EXPECT_TRUE(Coupling(virtualOne(), shows_force, kCutoff_hz, kTick_s).isVirtual());
  }
}

TEST(Coupling, OnlyAVirtualOneHasASpring) {
  EXPECT_EQ(Coupling(virtualOne(), true, kCutoff_hz, kTick_s).stiffness(), 300);
  EXPECT_TRUE(std::isinf(Coupling({}, true, kCutoff_hz, kTick_s).stiffness()));
}

TEST(Coupling, DirectlyTheToolIsWhereTheHandIsAndTheHandFeelsTheLowPassOfTheSoil) {
  Coupling coupling({}, true, kCutoff_hz, kTick_s);
  coupling.place(at(Vec3::Zero()));
  const double share = 1 - std::exp(-2 * std::numbers::pi * kCutoff_hz * kTick_s);
  Vec3 expected_n = Vec3::Zero();
  for (int tick = 0; tick < 100; ++tick) {
    const HandState hand = at(Vec3(0, 0, 1e-4 * tick), Vec3(0, 0, 0.1));
    const HandState& tool = coupling.moveTool(hand);
    ASSERT_EQ(tool.pose.position_m, hand.pose.position_m);
    ASSERT_EQ(tool.twist.linear_m_s, hand.twist.linear_m_s);
    const Vec3 soil_n(std::sin(0.1 * tick), 2, -1);
    expected_n += share * (soil_n - expected_n);
    ASSERT_LT((coupling.feel({{soil_n, Vec3::Zero()}}, kNoStiffness).wrench.force_n - expected_n).norm(), 1e-12);
  }
}

TEST(Coupling, DirectlyTheHandsOwnQuickMovementIsNotDelayed) {
  const Eigen::Matrix3d stiffness_n_m = Vec3(100, 200, 4000).asDiagonal();
  Coupling with({}, true, kCutoff_hz, kTick_s), without({}, true, kCutoff_hz, kTick_s);
  const HandState jerk = at(Vec3::Zero(), Vec3(0, 0, -0.05));
  (void)with.moveTool(jerk);
  (void)without.moveTool(jerk);
  const Vec3 more_n = with.feel({}, stiffness_n_m).wrench.force_n - without.feel({}, kNoStiffness).wrench.force_n;
  EXPECT_EQ(more_n.x(), 0);
  const double filter =
      std::exp(-2 * std::numbers::pi * kCutoff_hz * kTick_s);  // the low-pass pulls it to the soil's 0
  const double quick = std::exp(-2 * std::numbers::pi * 6 * kTick_s);
  EXPECT_NEAR(more_n.z(), filter * kTick_s * 4000 * quick * 0.05, 1e-9);
}

TEST(Coupling, AVirtualOneShowsNoMoreThanItsSpringAndDamperAndNoMoreThanItsLimit) {
  const CouplingParameters parameters = virtualOne();
  Coupling coupling(parameters, true, kCutoff_hz, kTick_s);
  HandState hand = at(Vec3(0, 0, 0.01));
  coupling.place(hand);
  HandState tool = hand;
  double largest_n = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    const double z = 0.01 - 0.06 * std::sin(0.004 * tick);
    hand = at(Vec3(0, 0, z), Vec3(0, 0, -0.06 * 4 * std::cos(0.004 * tick)));
    const double spring_n = parameters.spring.stiffness_n_m * (hand.pose.position_m - tool.pose.position_m).norm();
    const double damper_n = parameters.spring.damping_n_s_m * (hand.twist.linear_m_s - tool.twist.linear_m_s).norm();
    tool = coupling.moveTool(hand);
    const double felt_n = coupling.feel({wall(tool, 2000)}, kNoStiffness).wrench.force_n.norm();
    ASSERT_LE(felt_n, spring_n + damper_n + 1e-12) << tick;
    ASSERT_LE(felt_n, parameters.max_force_n + 1e-12) << tick;
    largest_n = std::max(largest_n, felt_n);
  }
  EXPECT_GT(largest_n, 11.9) << "it must have come to its limit, else nothing was tested";
}

TEST(Coupling, AVirtualOneAtRestShowsTheForceOfTheSoil) {
  Coupling coupling(virtualOne(), true, kCutoff_hz, kTick_s);
  const HandState hand = at(Vec3(0, 0, -0.02));
  coupling.place(at(Vec3(0, 0, 0.005)));
  Wrench soil, felt;
  HandState tool;
  for (int tick = 0; tick < 5000; ++tick) {
    tool = coupling.moveTool(hand);
    soil = wall(tool, 1000);
    felt = coupling.feel({soil}, kNoStiffness).wrench;
  }
  // Two springs in a row: 300 and 1000 N/m over 20 mm.
  EXPECT_NEAR(soil.force_n.z(), 0.02 * 300 * 1000 / 1300, 1e-6);
  EXPECT_LT((felt.force_n - soil.force_n).norm(), 1e-9);
  EXPECT_LT(tool.twist.linear_m_s.norm(), 1e-9);
}

TEST(Coupling, ThePlacedToolIsAtRestAndPullsNothing) {
  Coupling coupling(virtualOne(), true, kCutoff_hz, kTick_s);
  coupling.place(at(Vec3::Zero()));
  (void)coupling.moveTool(at(Vec3(0.05, 0, 0), Vec3(1, 0, 0)));
  EXPECT_GT(coupling.feel({{Vec3(5, 0, 0), Vec3::Zero()}}, kNoStiffness).wrench.force_n.norm(), 1);
  const HandState there = at(Vec3(0.3, 0.2, 0.1));
  coupling.place(there);
  const HandState& tool = coupling.moveTool(there);
  EXPECT_EQ(tool.pose.position_m, there.pose.position_m);
  EXPECT_EQ(tool.twist.linear_m_s, Vec3::Zero()) << "the soil's force from before is forgotten, too";
  EXPECT_EQ(coupling.feel({}, kNoStiffness).wrench.force_n.norm(), 0);
}

TEST(Coupling, RefusesNonsense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::function<void(CouplingParameters&)> spoils[] = {
      [](CouplingParameters& c) { c.spring.stiffness_n_m = 0; },
      [=](CouplingParameters& c) { c.spring.stiffness_n_m = nan; },
      [](CouplingParameters& c) { c.spring.stiffness_n_m = 2e5; },
      [](CouplingParameters& c) { c.spring.damping_n_s_m = -1; },
      [=](CouplingParameters& c) { c.spring.damping_n_s_m = nan; },
      [](CouplingParameters& c) { c.spring.mass_kg = 0; },
      [=](CouplingParameters& c) { c.spring.mass_kg = nan; },
      [](CouplingParameters& c) { c.spring.lever_m = 0; },
      [](CouplingParameters& c) { c.max_force_n = 0; },
      [=](CouplingParameters& c) { c.max_force_n = nan; },
      [](CouplingParameters& c) { c.spring.mass_kg = (300 * 1e-6 + 2 * 19 * 1e-3) / 4; },  // just too light
  };
  int number = 0;
  for (const auto& spoil : spoils) {
    CouplingParameters parameters = virtualOne();
    spoil(parameters);
    EXPECT_THROW((Coupling{parameters, true, kCutoff_hz, kTick_s}), InvalidParameter) << number++;
  }
  EXPECT_THROW((Coupling{{}, true, 0, kTick_s}), InvalidParameter);
  EXPECT_THROW((Coupling{{}, true, 501, kTick_s}), InvalidParameter);
  CouplingParameters light = virtualOne();
  light.spring.mass_kg = 1.01 * (300 * 1e-6 + 2 * 19 * 1e-3) / 4;
  EXPECT_NO_THROW((Coupling{light, true, kCutoff_hz, kTick_s}));
}

TEST(SuitsDirectly, ADeviceThatShowsForceSoonEnough) {
  DeviceLimits device;
  EXPECT_TRUE(suitsDirectly(device));
  device.delay_s = 0.001;
  EXPECT_TRUE(suitsDirectly(device));
  device.delay_s = 0.002;
  EXPECT_FALSE(suitsDirectly(device));
  device.delay_s = 0;
  device.resolution_m = 2e-5;
  EXPECT_TRUE(suitsDirectly(device));
  device.resolution_m = 3e-5;
  EXPECT_FALSE(suitsDirectly(device));
  device.resolution_m = 0;
  device.shows_force = false;
  EXPECT_FALSE(suitsDirectly(device));
}

}  // namespace
}  // namespace haptolith
