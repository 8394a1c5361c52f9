#include "haptolith/scene/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

constexpr double kTick_s = 1e-3;

BedParameters icra2021Bed() {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  return bed;
}

/// Moves the tool's height at a constant speed and returns the unfiltered upward force in each tick.
std::vector<double> moveTo(Scene& scene, double height_m, double speed_m_s) {
  std::vector<double> forces;
  const double from = scene.toolPose().position_m.z();
  const int ticks = std::max(1, static_cast<int>(std::round(std::abs(height_m - from) / speed_m_s / kTick_s)));
  const Twist twist{Vec3(0, 0, (height_m - from) / (ticks * kTick_s)), Vec3::Zero()};
  for (int i = 1; i <= ticks; ++i) {
    const Pose pose{Vec3(0, 0, from + (height_m - from) * i / ticks), Quat::Identity()};
    EXPECT_EQ(scene.tick({{pose, twist}}), StepStatus::kOk);
    forces.push_back(scene.soilWrench().force_n.z());
  }
  return forces;
}

TEST(Scene, RefusesWrongPartsAndHopelessSteps) {
  BedParameters bed = icra2021Bed();
  bed.width_m = -1;
  EXPECT_THROW((Scene{bed, ToolParameters{}}), InvalidParameter);
  ToolParameters tool;
  tool.thickness_m = 0;
  EXPECT_THROW((Scene{icra2021Bed(), tool}), InvalidParameter);
  tool = {};
  tool.stiffness_n_m = 1e7;
  EXPECT_THROW((Scene{icra2021Bed(), tool}), InvalidParameter);
}

TEST(Scene, ForceRisesWithDepth) {
  Scene scene(icra2021Bed(), ToolParameters{});
  const double surface = scene.bed().surfaceHeight();
  const double touch = surface + 0.0025;  // the lower face of a shovel 5 mm thick at the surface
  scene.placeTool({{{Vec3(0, 0, touch + 0.002), Quat::Identity()}, {}}});
  moveTo(scene, touch + 1e-4, 0.02);
  const std::vector<double> forces = moveTo(scene, touch - 0.010, 0.01);  // 10 mm in a second
  constexpr std::size_t kBins = 5;
  double before = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    double mean = 0;
    const std::size_t size = forces.size() / kBins;
    for (std::size_t i = 0; i < size; ++i) {
      mean += forces[bin * size + i] / static_cast<double>(size);
    }
    EXPECT_GT(mean, before) << "bin " << bin << " of 2 mm";
    before = mean;
  }
  EXPECT_GT(before, 0.1);
  EXPECT_LT(before, 20);
}

TEST(Scene, LiftingPullsByAdhesionBeforeItLetsGo) {
  Scene scene(icra2021Bed(), ToolParameters{});
  const double touch = scene.bed().surfaceHeight() + 0.0025;
  scene.placeTool({{{Vec3(0, 0, touch + 0.002), Quat::Identity()}, {}}});
  moveTo(scene, touch - 0.002, 0.01);
  moveTo(scene, touch - 0.002, 0.01);
  const std::vector<double> lifting = moveTo(scene, touch + 0.02, 0.01);
  EXPECT_LT(*std::min_element(lifting.begin(), lifting.end()), -1e-4);
  // A particle that sticks weighs 4.3 mN; the zone of 14 um holds 7 mN. Whatever sticks, the force is its weight.
  EXPECT_GT(lifting.back(), -0.1);
}

TEST(Scene, AboveTheSoilThereIsExactlyNothing) {
  Scene scene(icra2021Bed(), ToolParameters{});
  scene.placeTool({{{Vec3(0, 0, 0.2), Quat::Identity()}, {}}});
  moveTo(scene, 0.1, 0.5);
  EXPECT_EQ(scene.soilWrench().force_n, Vec3::Zero());
  EXPECT_EQ(scene.soilWrench().torque_nm, Vec3::Zero());
  const std::uint64_t with_tool = stateHash(scene.bed().state());
  Bed alone(icra2021Bed());
  while (alone.state().step < scene.bed().state().step) {
    ASSERT_EQ(alone.step(kTick_s), StepStatus::kOk);
  }
  EXPECT_EQ(stateHash(alone.state()), with_tool);  // and the bed does not know that there is a tool
}

TEST(Scene, SubstepsMoveTheToolInEqualPartsAndMeanTheWrench) {
  BedParameters bed = icra2021Bed();
  bed.tick_s = 4e-3;  // 754 rad/s * 4 ms: four substeps
  Scene scene(bed, ToolParameters{});
  ASSERT_EQ(scene.substeps(), 4);
  scene.placeTool({{{Vec3(0, 0, 0.2), Quat::Identity()}, {}}});
  ASSERT_EQ(scene.tick({{{Vec3(0, 0, 0.1), Quat::Identity()}, {}}}), StepStatus::kOk);
  EXPECT_EQ(scene.bed().state().step, 4U);
  EXPECT_EQ(scene.toolPose().position_m, Vec3(0, 0, 0.1));
}

TEST(Scene, MovesNoGrainThatLiesNearTheToolNorToThere) {
  BedParameters bed = icra2021Bed();
  bed.width_m = bed.length_m = 0.3;
  bed.start = BedStart::kPacked;
  Scene scene(bed, ToolParameters{});
  const double above_m = scene.bed().surfaceHeight() + 8e-3;
  std::size_t left = 0;  // the highest in the corner
  for (std::size_t i = 0; i < scene.bed().particles(); ++i) {
    const Float4& at = scene.bed().state().position[i];
    const Float4& best = scene.bed().state().position[left];
    left = at.x - at.z * -10 < best.x - best.z * -10 ? left : i;
  }
  const Float4& at = scene.bed().state().position[left];
  const Vec3 from_m(at.x, at.y, at.z);
  const Vec3 far_m(-0.12, -0.12, above_m);
  const auto place_tool = [&](const Vec3& place_m) { scene.placeTool({{{place_m, Quat::Identity()}, {}}}); };
  place_tool(from_m);
  EXPECT_FALSE(scene.moveGrain({left, from_m, far_m}));
  place_tool(far_m);
  EXPECT_FALSE(scene.moveGrain({left, from_m, far_m}));
  place_tool({0, 0, 0.5});
  EXPECT_TRUE(scene.moveGrain({left, from_m, far_m}));
  EXPECT_EQ(scene.bed().state().position[left].x, -0.12F);
}

TEST(Scene, AToolThatIsNowhereMovesNoSoilAndTheSceneGoesOn) {
  Scene scene(icra2021Bed(), ToolParameters{});
  const double z = scene.bed().surfaceHeight();
  const HandState here{{{Vec3(0, 0, z), Quat::Identity()}, {}}};
  scene.placeTool(here);
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(scene.tick(here), StepStatus::kOk);
  }
  ASSERT_GT(scene.soilWrench().force_n.norm(), 0);
  const std::uint64_t before = stateHash(scene.bed().state());
  const auto with = [&](auto change) {
    HandState hand = here;
    change(hand);
    return hand;
  };
  std::vector<HandState> nowhere;
  for (const double number : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (int axis = 0; axis < 3; ++axis) {
      nowhere.push_back(with([&](HandState& hand) { hand.pose.position_m(axis) = number; }));
      nowhere.push_back(with([&](HandState& hand) { hand.twist.linear_m_s(axis) = number; }));
      nowhere.push_back(with([&](HandState& hand) { hand.twist.angular_rad_s(axis) = number; }));
    }
    nowhere.push_back(with([&](HandState& hand) { hand.pose.orientation.x() = number; }));
  }
  nowhere.push_back(with([](HandState& hand) { hand.pose.orientation.coeffs().setZero(); }));
  for (const HandState& hand : nowhere) {
    EXPECT_EQ(scene.tick(hand), StepStatus::kNotFinite);
    EXPECT_TRUE(scene.soilWrench().isZero());
    scene.placeTool(hand);
    EXPECT_EQ(scene.toolPose().position_m, here.pose.position_m);
    EXPECT_EQ(stateHash(scene.bed().state()), before);
  }
  EXPECT_EQ(scene.tick(here), StepStatus::kOk);
  EXPECT_GT(scene.soilWrench().force_n.norm(), 0);
}

}  // namespace
}  // namespace haptolith
