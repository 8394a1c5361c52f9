#include "haptolith/lab/tests/plate.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "haptolith/core/error.h"
#include "haptolith/figure/figure.h"

namespace haptolith {

namespace {

constexpr double kPlateMmPerM = 1000;
constexpr double kWidestBed_m = 10;

/// Fraction of rho0 g D, the pressure scale of the soil under a plate, that counts as contact.
constexpr double kPlateContactShare = 0.05;

/// v^2/(g D): equal on all bodies, so that forces scale with gravity.
constexpr double kPlateInertia = 0.004;

/// Thickness over diameter; soil does not flow onto the plate at a smaller sinkage.
constexpr double kThickness = 1.0;

/// Stiffness over that of the particles; the plate must not deform before they do.
constexpr double kPlateStiffness = 2;

Push plateInto(const LabConditions& conditions, const PlateOptions& options, double area_m2) {
  Push push;
  push.what = "the plate sinks in";
  push.tool.shape = ToolShape::kPlate;
  push.tool.diameter_m = options.diameter_m;
  push.tool.thickness_m = kThickness * options.diameter_m;
  push.tool.stiffness_n_m = kPlateStiffness * conditions.soil.stiffness_n_m;
  push.tool.friction = options.friction;
  push.zero_m = push.lowest_m = -push.tool.thickness_m / 2;
  push.contact_n =
      kPlateContactShare * conditions.soil.rho0_kg_m3 * conditions.gravity_m_s2 * options.diameter_m * area_m2;
  push.depth_m = options.max_sinkage_m;
  push.speed_m_s = options.speed_m_s.value_or(std::sqrt(kPlateInertia * conditions.gravity_m_s2 * options.diameter_m));
  push.sample_m = options.max_sinkage_m / options.points;
  push.window_m = options.window_m;
  push.bed_width_m = options.bed_width_diameters * options.diameter_m;
  push.bed_depth_m = options.bed_depth_diameters * options.diameter_m;
  push.preparation = options.preparation;
  push.depth_from = options.depth_from;
  push.loose_top_m = options.loose_top_m;
  return push;
}

}  // namespace

void validate(const LabConditions& conditions, const PlateOptions& options) {
  validate(conditions.soil);
  requireInRange("gravity_m_s2", conditions.gravity_m_s2, {0, 1000, Ends::kOpenBelow});
  requireInRange("bed_width_diameters", options.bed_width_diameters, {2, 100});
  requireInRange("diameter_m", options.diameter_m,
                 {8 * conditions.soil.radius_m,
                  std::floor(kPlateMmPerM * kWidestBed_m / options.bed_width_diameters) / kPlateMmPerM});
  requireInRange("max_sinkage_m", options.max_sinkage_m, {0, kThickness * options.diameter_m, Ends::kOpenBelow});
  if (options.speed_m_s) {
    requireInRange("speed_m_s", *options.speed_m_s, {0, 10, Ends::kOpenBelow});
  }
  requireInRange("friction", options.friction, {0, 10});
  requireInRange("bed_depth_diameters", options.bed_depth_diameters,
                 {options.max_sinkage_m / options.diameter_m, 100, Ends::kOpenBelow});
  requireInRange("loose_top_m", options.loose_top_m,
                 {0, options.bed_depth_diameters * options.diameter_m - 4 * conditions.soil.radius_m});
  requireInRange("window_m", options.window_m, {0, options.max_sinkage_m, Ends::kOpenBelow});
  requireInRange("points", options.points, {3, 100'000});
}

PlateResult plateTest(const LabConditions& conditions, const PlateOptions& options) {
  validate(conditions, options);
  PlateResult result;
  result.area_m2 = std::numbers::pi / 4 * options.diameter_m * options.diameter_m;
  PushCurve push = pushIntoBed(conditions, plateInto(conditions, options, result.area_m2));
  result.curve = std::move(push.readings);
  result.bulk_density_kg_m3 = push.bulk_density_kg_m3;
  result.bed_depth_m = push.bed_depth_m;
  result.particles = push.particles;

  std::vector<SinkagePoint> pressures;
  result.trace.columns = {"sinkage_m", "force_n", "pressure_pa"};
  for (const PushReading& reading : result.curve) {
    pressures.push_back({reading.depth_m, reading.force_n / result.area_m2});
    result.trace.rows.push_back({reading.depth_m, reading.force_n, pressures.back().pressure_pa});
  }
  try {
    result.fit = fitPressureSinkage(pressures);
  } catch (const Failure&) {  // no power law: the readings are still valid
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    result.fit = {.modulus = kNone, .exponent = kNone, .residual_rms_pa = kNone};
  }
  return result;
}

void drawPlate(const OutputFile& file, const PlateResult& result, std::string_view title,
               const std::vector<MeasuredPlate>& measured) {
  Figure figure(file, 900, 600);
  std::vector<std::vector<double>> simulated;
  std::vector<std::vector<double>> fitted;
  for (const PushReading& reading : result.curve) {
    simulated.push_back({reading.depth_m * kPlateMmPerM, reading.force_n});
    fitted.push_back({reading.depth_m * kPlateMmPerM, result.fit.pressureAt(reading.depth_m) * result.area_m2});
  }
  figure.data("simulated", simulated);
  figure.data("fitted", fitted);
  std::string plot = fmt::format(
      "plot $simulated using 1:2 with lines linewidth 2.5 linecolor rgb '#0072b2' title 'simulated', "
      "$fitted using 1:2 with lines dashtype (8,5) linewidth 1.5 linecolor rgb '#d55e00' title 'p = k z^n, n = {:.2f}'",
      result.fit.exponent);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    std::vector<std::vector<double>> rows;
    for (const PushReading& point : measured[i].points) {
      rows.push_back({point.depth_m * kPlateMmPerM, point.force_n});
    }
    figure.data(fmt::format("measured{}", i), rows);
    plot += fmt::format(", $measured{} using 1:2 with lines linewidth 1 linecolor rgb '#888888' title {}", i,
                        gnuplotQuoted(measured[i].title));
  }
  figure.command(
      "set xlabel 'sinkage / mm'; set ylabel 'force / N'; set key tmargin center horizontal; set xrange [0:*]; "
      "set yrange [0:*]");
  figure.command(fmt::format("set title {}", gnuplotQuoted(title)));
  figure.command(plot);
  figure.save();
}

}  // namespace haptolith
