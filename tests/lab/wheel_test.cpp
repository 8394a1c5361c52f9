#include "haptolith/lab/tests/wheel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/tool/joint.h"

#include "csv_rows.h"
#include "small_soil.h"

namespace haptolith {
namespace {

constexpr double kCoarse_m = 7e-3;
constexpr double kRadPerDegree = std::numbers::pi / 180;

WheelOptions quick(std::vector<WheelSetting> settings) {
  WheelOptions options;
  options.settings = std::move(settings);
  options.travel_m = 0.08;
  options.bed_depth_m = 0.09;
  options.side_room_m = 0.04;
  return options;
}

/// Bed with a little soil in one corner, far from the wheel.
std::unique_ptr<LabBed> almostEmptyBed(const LabConditions& conditions, const ToolParameters& tool) {
  const LabBox box{.width_m = 0.6, .length_m = 0.3};
  auto bed = std::make_unique<LabBed>(conditions, box, std::vector<Vec3>{{-0.28, -0.13, 0.01}},
                                      std::vector<std::vector<Vec3>>{}, tool);
  bed->placeTool({{0, 0, 100}, Quat::Identity()});
  bed->settle();
  return bed;
}

TEST(WheelRig, TurnsAWheelInEmptySpaceWithoutForce) {
  const LabConditions conditions = coarseSand(kCoarse_m);
  const ToolParameters tool = wheelTool({}, conditions.soil);
  const std::unique_ptr<LabBed> empty = almostEmptyBed(conditions, tool);
  LabBed& bed = *empty;
  bed.driveJoint(2);
  const double before_rad = bed.joint().angle_rad;
  bed.run(0.5, "", {});
  EXPECT_NEAR(bed.joint().angle_rad - before_rad, 2 * 0.5, 3 * bed.dt());
  EXPECT_EQ(bed.joint().motor_torque_nm, 0);
  EXPECT_EQ(bed.toolWrench().force_n, Vec3::Zero());
}

TEST(WheelRig, FallsFreelyUnderItsLoad) {
  const LabConditions conditions = coarseSand(kCoarse_m);
  WheelRun run;
  run.tool = wheelTool({}, conditions.soil);
  run.radius_m = run.below_m = 0.058;
  run.travel_m_s = 0.1;
  run.travel_m = 0.02;
  run.load_n = 0.1;
  run.mass_kg = 2;
  const std::unique_ptr<LabBed> bed = almostEmptyBed(conditions, run.tool);
  run.surface_m = bed->bed().surfaceHeight();
  const std::vector<WheelReading> readings = runWheel(*bed, run);
  ASSERT_EQ(readings.size(), 20U);
  // The load grows for 0.3 s, then it is constant.
  const double a = 0.1 / 2;
  const double loading_s = 0.3;
  for (const WheelReading& reading : readings) {
    const double t = reading.travel_m / 0.1;
    const double fallen_m = a * loading_s * loading_s / 6 + a * loading_s / 2 * t + a * t * t / 2;
    EXPECT_NEAR(reading.sinkage_m, fallen_m, 0.02 * fallen_m);
    EXPECT_EQ(reading.vertical_n, 0);
    EXPECT_EQ(reading.drawbar_n, 0);
  }
}

TEST(WheelRig, StopsAtTheFloor) {
  const LabConditions conditions = coarseSand(kCoarse_m);
  WheelRun run;
  run.tool = wheelTool({}, conditions.soil);
  run.radius_m = run.below_m = 0.058;
  run.travel_m_s = 0.1;
  run.travel_m = 0.02;
  run.load_n = 20;
  run.mass_kg = 2;
  const std::unique_ptr<LabBed> bed = almostEmptyBed(conditions, run.tool);
  EXPECT_THROW(static_cast<void>(runWheel(*bed, run)), Failure);
}

TEST(Wheel, CarriesItsLoadAndUsesMoreWorkThanItGives) {
  const WheelOptions options = quick({{0.3, 0, 20}, {-0.5, 0, 20}});
  const WheelResult result = wheelTest(coarseSand(kCoarse_m), options);
  ASSERT_EQ(result.points.size(), 2U);
  for (const WheelPoint& point : result.points) {
    EXPECT_NEAR(point.vertical_n.value, 20, 1);
    EXPECT_GT(point.sinkage_m.value, 1e-3);
    EXPECT_LT(point.sinkage_m.value, 0.058);
    const double power_in = point.torque_nm.value * point.rim_m_s / result.radius_m;
    EXPECT_GT(power_in, point.drawbar_n.value * point.travel_m_s);
  }
  EXPECT_NEAR(result.points[0].rim_m_s, 0.08 / 0.7, 1e-9);
  EXPECT_NEAR(result.points[1].rim_m_s, 0.04, 1e-9);
  EXPECT_GT(result.points[0].drawbar_n.value, result.points[1].drawbar_n.value);
  EXPECT_GT(result.points[0].torque_nm.value, result.points[1].torque_nm.value);
}

TEST(Wheel, HasOppositeSideForcesAtOppositeSlipAngles) {
  const WheelResult result =
      wheelTest(coarseSand(kCoarse_m), quick({{0, 45 * kRadPerDegree, 20}, {0, -45 * kRadPerDegree, 20}}));
  const double left_n = result.points[0].side_n.value;
  const double right_n = result.points[1].side_n.value;
  EXPECT_GT(left_n, 2);
  EXPECT_LT(right_n, -2);
  EXPECT_NEAR(left_n, -right_n, 0.35 * left_n);  // another part of the bed
  EXPECT_NEAR(result.points[0].drawbar_n.value, result.points[1].drawbar_n.value, 0.2 * 20);
}

TEST(Wheel, KeepsAConstantSinkage) {
  WheelOptions options = quick({{0.2, 0, 0}});
  options.sinkage_m = 0.012;
  options.steady_from = 0.4;
  const WheelResult result = wheelTest(coarseSand(kCoarse_m), options);
  EXPECT_NEAR(result.points[0].sinkage_m.value, 0.012, 1e-4);
  EXPECT_LT(result.points[0].sinkage_m.sd, 1e-4);
  EXPECT_TRUE(result.points[0].is_steady);
  EXPECT_GT(result.points[0].vertical_n.value, 1);
}

TEST(Wheel, GripsMoreWithGrousers) {
  const LabConditions conditions = coarseSand(kCoarse_m);
  WheelOptions options = quick({{0.5, 0, 6}});
  options.travel_m = 0.05;
  options.wheel.diameter_m = 0.06;
  options.wheel.width_m = 0.04;
  const double smooth_nm = wheelTest(conditions, options).points[0].torque_nm.value;
  options.wheel.grousers = 12;
  options.wheel.grouser_height_m = 0.01;
  options.wheel.grouser_thickness_m = 0.003;
  EXPECT_GT(wheelTest(conditions, options).points[0].torque_nm.value, 1.2 * smooth_nm);
}

TEST(WheelRig, LetsTheSoilTurnAFreeWheel) {
  const LabConditions conditions = coarseSand(kCoarse_m);
  WheelRun run;
  run.tool = wheelTool({}, conditions.soil);
  run.tool.joint.drive = Drive::kFree;
  run.tool.joint.inertia_kg_m2 = 0.05;
  run.radius_m = run.below_m = 0.058;
  run.travel_m_s = 0.1;
  run.travel_m = 0.1;
  run.load_n = 20;
  run.mass_kg = 2;
  run.start_x_m = -0.05;
  const LabBox box{.width_m = 0.34, .length_m = 0.14};
  LabBed bed(conditions, box,
             looseSoil(conditions.soil, box, particlesFor(conditions.soil, box.width_m * box.length_m * 0.08), 0, 1),
             {}, run.tool);
  bed.placeTool({{0, 0, 100}, Quat::Identity()});
  bed.settle();
  run.surface_m = bed.levelSurface();
  const std::vector<WheelReading> readings = runWheel(bed, run);
  EXPECT_EQ(readings.back().torque_nm, 0);
  EXPECT_GT(readings.back().rim_m_s, 0.01);
  EXPECT_LT(readings.back().rim_m_s, 0.15);
  run.tool.joint.inertia_kg_m2 = 1e-9;
  EXPECT_THROW(static_cast<void>(runWheel(bed, run)), InvalidParameter);
  run.tool.joint.drive = Drive::kNone;
  EXPECT_THROW(static_cast<void>(runWheel(bed, run)), InvalidParameter);
}

TEST(Wheel, IsComparedWithBothTheories) {
  WheelOptions options = quick({{0.3, 0, 10}, {0.3, 30 * kRadPerDegree, 10}});
  options.friction_angle_rad = 30 * kRadPerDegree;
  options.plate = {.modulus = 8e5, .exponent = 1};
  const WheelResult result = wheelTest(coarseSand(kCoarse_m), options);
  ASSERT_TRUE(result.points[0].bekker);
  EXPECT_FALSE(result.points[1].bekker);  // it has no slip angle
  EXPECT_NEAR(result.points[0].bekker->vertical_n, 10, 1e-6);
  for (const WheelPoint& point : result.points) {
    ASSERT_TRUE(point.resistive);
    EXPECT_NEAR(point.resistive->vertical_n, 10, 0.2);
    EXPECT_GT(point.resistive->torque_nm, 0);
  }
  EXPECT_NEAR(result.points[0].resistive->side_n, 0, 0.1);
  EXPECT_GT(result.points[1].resistive->side_n, 1);
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "haptolith_wheel.svg";
  std::filesystem::remove(file);
  drawWheel(file, result, "wheel", {{{0.3, 0, 10}, -1, 0, 0.01}});
  EXPECT_GT(std::filesystem::file_size(file), 1000U);
  std::filesystem::remove(file);
}

// A smooth wheel in dry sand. The theory carries the load and is compared without the soil's bed.
TEST(ResistiveWheel, IsNearTheMeasuredWheel) {
  const LabConditions conditions = coarseSand(kCoarse_m);
  const WheelOptions options;
  const ToolParameters tool = wheelTool(options.wheel, conditions.soil);
  const ResistiveSoil sand{
      .density_kg_m3 = 1330, .gravity_m_s2 = 9.807, .internal_friction = std::tan(29 * kRadPerDegree)};
  std::vector<MeasuredWheel> measured;
  std::vector<WheelEstimate> theory;
  for (const std::vector<double>& row : csvRows("wheel_smooth_measured.csv")) {
    measured.push_back({{std::max(-1.0, row[3]), row[0] * kRadPerDegree, row[11]}, row[5], row[8], row[12] * 1e-3});
    const auto forces = resistiveWheel(options, tool, measured.back().setting, sand);
    ASSERT_TRUE(forces);
    EXPECT_NEAR(forces->vertical_n, row[11], 0.05 * row[11]);
    theory.push_back({forces->drawbar_n, forces->side_n, forces->sinkage_m});
  }
  const WheelComparison comparison = compareWheel(measured, theory);
  EXPECT_EQ(comparison.points, 63U);
  EXPECT_EQ(comparison.slipping, 49U);
  EXPECT_LT(comparison.drawbar_error, 0.17);
  EXPECT_LT(comparison.side_error, 0.16);
  EXPECT_GT(comparison.drawbar_sign, 0.6);
  EXPECT_GT(comparison.side_sign, 0.9);
  EXPECT_GT(comparison.sinkage_within, 0.7);
}

TEST(WheelComparison, CountsSignsAndSinkages) {
  const std::vector<MeasuredWheel> measured{
      {{0.5, 0, 10}, 1, 1, 0.010}, {{-0.5, 0, 20}, -4, 2, 0.020}, {{0, 0, 10}, 1, 0, 0.010}};
  const WheelComparison comparison = compareWheel(measured, {{2, 1, 0.013}, {-8, -2, 0.030}, {-1, 1, 0.010}});
  EXPECT_EQ(comparison.points, 3U);
  EXPECT_EQ(comparison.slipping, 2U);
  EXPECT_DOUBLE_EQ(comparison.drawbar_error, 0.2);  // median of 0.1, 0.2, 0.2
  EXPECT_DOUBLE_EQ(comparison.side_error, 0.1);     // median of 0, 0.2, 0.1
  EXPECT_EQ(comparison.drawbar_sign, 1);
  EXPECT_EQ(comparison.side_sign, 0.5);
  EXPECT_DOUBLE_EQ(comparison.sinkage_within, 2.0 / 3);
  EXPECT_THROW(static_cast<void>(compareWheel(measured, {})), InvalidParameter);
}

TEST(Wheel, RefusesNonsense) {
  const LabConditions conditions = coarseSand(kCoarse_m);
  const std::vector<std::function<void(WheelOptions&)>> nonsense{
      [](WheelOptions& o) { o.settings.clear(); },
      [](WheelOptions& o) { o.settings[0].slip = 1; },
      [](WheelOptions& o) { o.settings[0].slip = -1.1; },
      [](WheelOptions& o) { o.settings[0].slip_angle_rad = 2; },
      [](WheelOptions& o) { o.settings[0].load_n = 0; },
      [](WheelOptions& o) { o.settings[0].load_n = std::numeric_limits<double>::quiet_NaN(); },
      [](WheelOptions& o) { o.wheel.diameter_m = 7 * kCoarse_m; },
      [](WheelOptions& o) { o.wheel.width_m = 0; },
      [](WheelOptions& o) { o.wheel.grousers = 61; },
      [](WheelOptions& o) { o.wheel.grouser_height_m = 0; },
      [](WheelOptions& o) { o.sinkage_m = 0.2; },
      [](WheelOptions& o) { o.travel_m_s = 0; },
      [](WheelOptions& o) { o.travel_m = 0; },
      [](WheelOptions& o) { o.steady_from = 1; },
      [](WheelOptions& o) { o.bed_depth_m = 1e-3; },
      [](WheelOptions& o) { o.friction_angle_rad = 2; },
      [](WheelOptions& o) { o.mass_kg = -1; },
  };
  for (std::size_t i = 0; i < nonsense.size(); ++i) {
    WheelOptions options = quick({{0.3, 0, 20}});
    nonsense[i](options);
    EXPECT_THROW(static_cast<void>(wheelTest(conditions, options)), InvalidParameter) << i;
  }
}

}  // namespace
}  // namespace haptolith
