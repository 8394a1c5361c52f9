#include "haptolith/lab/tests/cone.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/figure/figure.h"
#include "haptolith/lab/theory/straight_line.h"

namespace haptolith {

namespace {

/// Stiffness over that of the particles; the cone must not deform before they do.
constexpr double kConeStiffness = 2;

void validate(const LabConditions& conditions, const ConeOptions& options) {
  validate(conditions.soil);
  requireInRange("gravity_m_s2", conditions.gravity_m_s2, {0, 1000, Ends::kOpenBelow});
  requireInRange("base_diameter_m", options.base_diameter_m, {2 * conditions.soil.radius_m, 1});
  requireInRange("cone_angle_rad", options.cone_angle_rad, {0.1, 3});
  requireInRange("max_depth_m", options.max_depth_m, {0, 5, Ends::kOpenBelow});
  requireInRange("speed_m_s", options.speed_m_s, {0, 10, Ends::kOpenBelow});
  requireInRange("friction", options.friction, {0, 10});
  requireInRange("bed_width_diameters", options.bed_width_diameters, {4, 100});
  requireInRange("below_diameters", options.below_diameters, {0.5, 100});
  requireInRange("window_m", options.window_m, {0, options.max_depth_m, Ends::kOpenBelow});
  requireInRange("points", options.points, {3, 100'000});
}

Push coneInto(const LabConditions& conditions, const ConeOptions& options) {
  const double height = options.base_diameter_m / 2 / std::tan(options.cone_angle_rad / 2);
  Push push;
  push.what = "the cone goes in";
  push.tool.shape = ToolShape::kCone;
  push.tool.diameter_m = options.base_diameter_m;
  push.tool.cone_angle_rad = options.cone_angle_rad;
  push.tool.length_m = 2 * (height + options.max_depth_m);  // the shaft's end stays above the soil
  push.tool.stiffness_n_m = kConeStiffness * conditions.soil.stiffness_n_m;
  push.tool.friction = options.friction;
  push.zero = DepthZero::kSurface;
  push.zero_m = height;
  push.lowest_m = 0;
  push.depth_m = options.max_depth_m;
  push.speed_m_s = options.speed_m_s;
  push.sample_m = options.max_depth_m / options.points;
  push.window_m = options.window_m;
  push.bed_width_m = options.bed_width_diameters * options.base_diameter_m;
  push.bed_depth_m = options.max_depth_m + height + options.below_diameters * options.base_diameter_m;
  push.preparation = options.preparation;
  push.depth_from = options.depth_from;
  return push;
}

}  // namespace

ConeResult coneTest(const LabConditions& conditions, const ConeOptions& options) {
  validate(conditions, options);
  const double area = std::numbers::pi / 4 * options.base_diameter_m * options.base_diameter_m;
  const PushCurve push = pushIntoBed(conditions, coneInto(conditions, options));
  ConeResult result;
  result.bulk_density_kg_m3 = push.bulk_density_kg_m3;
  result.bed_depth_m = push.bed_depth_m;
  result.particles = push.particles;
  result.trace.columns = {"depth_m", "force_n", "resistance_pa"};
  std::vector<double> depths;
  std::vector<double> resistances;
  for (const PushReading& reading : push.readings) {
    const double resistance = reading.force_n / area;
    result.curve.push_back({reading.depth_m, resistance});
    result.trace.rows.push_back({reading.depth_m, reading.force_n, resistance});
    result.cone_index_pa += resistance / static_cast<double>(push.readings.size());
    depths.push_back(reading.depth_m);
    resistances.push_back(resistance);
  }
  result.gradient_pa_m = fitStraightLine(depths, resistances).slope;
  return result;
}

void drawCone(const OutputFile& file, const ConeResult& result, std::string_view title) {
  constexpr double kMmPerM = 1000;
  constexpr double kPaPerKpa = 1000;
  Figure figure(file, 700, 800);
  std::vector<std::vector<double>> rows;
  double deepest = 0;
  for (const ConePoint& point : result.curve) {
    rows.push_back({point.resistance_pa / kPaPerKpa, point.depth_m * kMmPerM});
    deepest = std::max(deepest, point.depth_m);
  }
  const double index = result.cone_index_pa / kPaPerKpa;
  const double half_way = result.gradient_pa_m * deepest / 2 / kPaPerKpa;
  figure.data("resistance", rows);
  figure.data("line", {{index - half_way, 0}, {index + half_way, deepest * kMmPerM}});
  figure.data("index", {{index, 0}, {index, deepest * kMmPerM}});
  figure.command(
      "set xlabel 'resistance / kPa'; set ylabel 'depth of the base / mm'; "
      "set yrange [0:*] reverse; set xrange [0:*]; set key tmargin center horizontal");
  figure.command(fmt::format("set title {}", gnuplotQuoted(title)));
  figure.command(
      fmt::format("plot $resistance using 1:2 with lines linewidth 2.5 linecolor rgb '#0072b2' title 'simulated', "
                  "$index using 1:2 with lines dashtype (8,5) linecolor rgb '#888888' title 'cone index {:.3g} kPa', "
                  "$line using 1:2 with lines dashtype (8,5) linecolor rgb '#d55e00' title 'gradient {:.3g} kPa/m'",
                  index, result.gradient_pa_m / kPaPerKpa));
  figure.save();
}

}  // namespace haptolith
