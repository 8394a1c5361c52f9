#include "haptolith/lab/tests/resistive_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/figure/figure.h"
#include "haptolith/lab/apparatus/pushed_tool.h"
#include "haptolith/lab/staged_progress.h"
#include "haptolith/lab/tests/blade.h"

namespace haptolith {

namespace {

constexpr double kMmPerM = 1000;
constexpr int kPoints = 40;  ///< number of points of a curve without its first

/// Stiffness over that of the particles; a tool must not deform before they do.
constexpr double kIntruderStiffness = 2;

/// Fraction of rho0 g D that counts as contact of the plate, as in plateTest().
constexpr double kContactShare = 0.05;

/// Fraction of the curve that is not evaluated: at first the plate only touches the tips of single particles.
constexpr double kReadFrom = 1.0 / 3;

/// Depth of the box, in D: three sinkages below the tool.
constexpr double kBedDepth = 1.8;

void validate(const LabConditions& conditions, const ResistiveOptions& options) {
  validate(conditions.soil);
  requireInRange("gravity_m_s2", conditions.gravity_m_s2, {0, 1000, Ends::kOpenBelow});
  requireInRange("diameter_m", options.diameter_m, {8 * conditions.soil.radius_m, 10});
  requireInRange("max_sinkage_m", options.max_sinkage_m, {0, options.diameter_m / 2, Ends::kOpenBelow});
  requireInRange("bed_width_diameters", options.bed_width_diameters, {2, 100});
  requireInRange("push_speed_m_s", options.push_speed_m_s, {0, 10, Ends::kOpenBelow});
  validate(options.shear);
  requireInRange("size_factor", options.size_factor, {1, 4, Ends::kOpenBelow});
  requireInRange("friction_angle_rad", options.friction_angle_rad, {0, 63 * std::numbers::pi / 180});
}

/// Tool that is pushed in.
struct Pushed {
  const char* name;
  ToolShape shape;
  bool lies = false;  ///< whether its axis is along y
};
constexpr std::array kPushed{Pushed{"plate", ToolShape::kPlate}, Pushed{"sphere", ToolShape::kSphere},
                             Pushed{"cone, 90°", ToolShape::kCone}, Pushed{"wheel", ToolShape::kCylinder, true}};
constexpr const Pushed& kPlate = kPushed[0];

ToolParameters pushedTool(const Pushed& what, double diameter_m, const LabConditions& conditions) {
  ToolParameters tool;
  tool.shape = what.shape;
  tool.diameter_m = diameter_m;
  tool.thickness_m = diameter_m;               // a plate is as thick as wide, so that no soil flows onto it
  tool.cone_angle_rad = std::numbers::pi / 2;  // blunt, because a sharp point touches single particles
  tool.length_m = what.lies ? diameter_m / 2 : diameter_m;
  tool.stiffness_n_m = kIntruderStiffness * conditions.soil.stiffness_n_m;
  return tool;
}

Quat standing(const Pushed& what) {
  return what.lies ? Quat(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitX())) : Quat::Identity();
}

/// Returns the height of a tool's lowest point over its origin.
double lowestPoint(const ToolParameters& tool) {
  return tool.shape == ToolShape::kCone ? 0 : -tool.diameter_m / 2;
}

double theoryPushed(const Push& push, double depth_m, const ResistiveSoil& soil) {
  const Pose pose{{0, 0, soil.surface_m - depth_m - push.lowest_m}, push.scene_R_tool};
  return resistiveForce(push.tool, 0, pose, {{0, 0, -1}, Vec3::Zero()}, soil).force_n.z();
}

ResistivePush pushed(const Pushed& what, const LabConditions& conditions, const ResistiveOptions& options, double size,
                     const ResistiveSoil& soil) {
  const double diameter_m = size * options.diameter_m;
  const double area_m2 = std::numbers::pi / 4 * diameter_m * diameter_m;
  Push push;
  push.what = "a tool sinks in";
  push.tool = pushedTool(what, diameter_m, conditions);
  push.scene_R_tool = standing(what);
  push.zero_m = push.lowest_m = lowestPoint(push.tool);
  push.zero = what.shape == ToolShape::kPlate ? DepthZero::kFirstContact : DepthZero::kSurface;
  push.contact_n = kContactShare * conditions.soil.rho0_kg_m3 * conditions.gravity_m_s2 * diameter_m * area_m2;
  push.depth_m = size * options.max_sinkage_m;
  push.speed_m_s = options.push_speed_m_s;
  push.sample_m = push.depth_m / kPoints;
  push.window_m = 2 * push.sample_m;
  push.bed_width_m = options.bed_width_diameters * diameter_m;
  push.bed_depth_m = kBedDepth * diameter_m;
  push.preparation = options.preparation;
  push.depth_from = options.depth_from;

  ResistivePush result;
  result.name = what.name;
  const PushCurve curve = pushIntoBed(conditions, push);
  result.bulk_density_kg_m3 = curve.bulk_density_kg_m3;
  int counted = 0;
  for (const PushReading& reading : curve.readings) {
    const double theory_n = theoryPushed(push, reading.depth_m, soil);
    result.curve.push_back({reading.depth_m, reading.force_n, theory_n});
    if (reading.depth_m >= kReadFrom * push.depth_m) {
      result.bed_n += reading.force_n;
      result.theory_n += theory_n;
      ++counted;
    }
  }
  result.bed_n /= counted;
  result.theory_n /= counted;
  return result;
}

/// Sets density and friction of the soil in the residual state, the inputs of the theory.
void measureSoil(const LabConditions& conditions, const ResistiveOptions& options, ResistiveResult& result) {
  const ShearResult shear = shearTest(conditions, options.shear);
  result.soil.gravity_m_s2 = conditions.gravity_m_s2;
  result.soil.density_kg_m3 = shear.bulk_density_kg_m3 / (1 + shear.points.front().dilation);
  result.soil.internal_friction = options.friction_angle_rad > 0
                                      ? std::tan(options.friction_angle_rad)
                                      : frictionWithoutCohesion(shear.points, &ShearPointResult::residual_pa);
  const bool loose = options.preparation != Preparation::kDense;
  result.peak_angle_rad = std::atan(
      frictionWithoutCohesion(shear.points, loose ? &ShearPointResult::residual_pa : &ShearPointResult::peak_pa));
}

void drawBladeBoth(const LabConditions& conditions, const ResistiveOptions& options, ResistiveResult& result) {
  constexpr double kDegree = std::numbers::pi / 180;
  BladeOptions blade_options;
  blade_options.width_m = options.blade_width_m;
  blade_options.depth_m = options.blade_depth_m;
  blade_options.speed_m_s = options.blade_speed_m_s;
  blade_options.preparation = options.preparation;
  blade_options.depth_from = options.depth_from;
  blade_options.friction_angle_rad = std::clamp(result.peak_angle_rad, 5 * kDegree, 59 * kDegree);
  const BladeResult blade = bladeTest(conditions, blade_options);
  result.blade_depth_m = blade.depth_m;
  result.draft_n = blade.draft_n;
  result.draft_se_n = blade.draft_se_n;
  result.vertical_n = blade.vertical_n;
  result.earthmoving_draft_n = blade.expected.undisturbed.earthmoving.draft_n;

  ToolParameters plate;  // as thin as in bladeTest(), half of it above the surface
  plate.shape = ToolShape::kBox;
  plate.size_m = {2e-3, options.blade_width_m, 2 * blade.depth_m};
  plate.friction = blade_options.tool_friction;
  const Wrench wrench = resistiveForce(plate, 0, {{0, 0, result.soil.surface_m}, Quat::Identity()},
                                       {{1, 0, 0}, Vec3::Zero()}, result.soil);
  result.theory_draft_n = -wrench.force_n.x();
  result.theory_vertical_n = -wrench.force_n.z();
}

ResistiveScaling scaling(std::string name, double factor, const ResistivePush& before, const ResistivePush& after) {
  const double force_factor = after.bed_n / before.bed_n;
  return {.name = std::move(name),
          .factor = factor,
          .force_factor = force_factor,
          .density_factor = after.bulk_density_kg_m3 / before.bulk_density_kg_m3,
          .exponent = std::log(force_factor) / std::log(factor),
          .theory_exponent = std::log(after.theory_n / before.theory_n) / std::log(factor)};
}

/// Repeats the plate test with one parameter changed, for each parameter.
void scale(const LabConditions& conditions, const ResistiveOptions& options, StagedProgress& progress,
           ResistiveResult& result) {
  const ResistivePush& plate = result.pushes.front();

  // Compares with lunar gravity or, under gravity as low as that, with Earth's.
  constexpr double kMoon_m_s2 = 1.625, kEarth_m_s2 = 9.807;
  progress.enter(0.50, 0.60);
  LabConditions elsewhere = conditions;
  elsewhere.gravity_m_s2 = conditions.gravity_m_s2 < 4 ? kEarth_m_s2 : kMoon_m_s2;
  ResistiveSoil soil = result.soil;
  soil.gravity_m_s2 = elsewhere.gravity_m_s2;
  result.scalings.push_back(scaling("gravity", elsewhere.gravity_m_s2 / conditions.gravity_m_s2, plate,
                                    pushed(kPlate, elsewhere, options, 1, soil)));

  constexpr double kDenser = 2;
  progress.enter(0.60, 0.70);
  LabConditions denser = conditions;
  denser.soil.rho0_kg_m3 *= kDenser;
  denser.soil.rho_max_kg_m3 *= kDenser;
  soil = result.soil;
  soil.density_kg_m3 *= kDenser;
  result.scalings.push_back(scaling("density", kDenser, plate, pushed(kPlate, denser, options, 1, soil)));

  progress.enter(0.70, 1.0);
  result.scalings.push_back(scaling("size", options.size_factor, plate,
                                    pushed(kPlate, conditions, options, options.size_factor, result.soil)));
}

}  // namespace

ResistiveResult resistiveComparison(const LabConditions& conditions, const ResistiveOptions& options) {
  validate(conditions, options);
  StagedProgress progress(conditions.progress);
  LabConditions without_cohesion = conditions;
  without_cohesion.soil.contact_cohesion_n = 0;
  without_cohesion.soil.attraction_ratio = 1;
  without_cohesion.progress = progress.inner();

  ResistiveResult result;
  const double of_scaling = options.scaling ? 0.5 : 1;
  progress.enter(0, 0.4 * of_scaling);
  measureSoil(without_cohesion, options, result);
  result.xi_n_m3 = resistiveScale(result.soil);

  progress.enter(0.4 * of_scaling, 0.55 * of_scaling);
  drawBladeBoth(without_cohesion, options, result);
  double begin = 0.55;
  for (const Pushed& what : kPushed) {
    constexpr double kEach = 0.45 / kPushed.size();
    progress.enter(begin * of_scaling, (begin + kEach) * of_scaling);
    begin += kEach;
    result.pushes.push_back(pushed(what, without_cohesion, options, 1, result.soil));
  }
  if (options.scaling) {
    scale(without_cohesion, options, progress, result);
  }
  result.trace.columns = {"sinkage_m", "force_n", "theory_n"};
  for (const ResistivePoint& point : result.pushes.front().curve) {
    result.trace.rows.push_back({point.depth_m, point.bed_n, point.theory_n});
  }
  return result;
}

void drawResistive(const OutputFile& file, const ResistiveResult& result, std::string_view title) {
  constexpr std::array kColours{"#0072b2", "#009e73", "#d55e00", "#cc79a7"};
  Figure figure(file, 900, 600);
  std::string plot = "plot ";
  for (std::size_t i = 0; i < result.pushes.size(); ++i) {
    std::vector<std::vector<double>> rows;
    for (const ResistivePoint& point : result.pushes[i].curve) {
      rows.push_back({point.depth_m * kMmPerM, point.bed_n, point.theory_n});
    }
    figure.data(fmt::format("push{}", i), rows);
    plot += fmt::format(
        "{}$push{} using 1:2 with lines linewidth 2.5 linecolor rgb '{}' title {}, "
        "$push{} using 1:3 with lines dashtype (8,5) linewidth 1.5 linecolor rgb '{}' title 'resistive force theory'",
        i == 0 ? "" : ", ", i, kColours.at(i), gnuplotQuoted(result.pushes[i].name), i, kColours.at(i));
  }
  figure.command(
      "set xlabel 'depth / mm'; set ylabel 'force / N'; set key tmargin center horizontal; set xrange [0:*]; "
      "set yrange [0:*]");
  figure.command(fmt::format("set title {}", gnuplotQuoted(title)));
  figure.command(plot);
  figure.save();
}

}  // namespace haptolith
