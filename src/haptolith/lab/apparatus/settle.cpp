#include "haptolith/lab/apparatus/settle.h"

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "haptolith/core/error.h"
#include "haptolith/core/vec.h"
#include "haptolith/figure/figure.h"
#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/soil/layers.h"
#include "haptolith/soil/lunar_density.h"

namespace haptolith {

namespace {

/// Returns the analytical layers of the soil. The analysis needs layers that carry the load; under strong gravity soft
/// soil has none.
std::vector<Layer> analysedLayers(const LabConditions& conditions, double depth_m) {
  try {
    return layersToDepth(conditions.soil, conditions.gravity_m_s2, depth_m);
  } catch (const Failure&) {
    return {};
  }
}

/// Returns the height of a column's surface. There the mass above a height is zero, by a parabola through the upper
/// soil except its rough top; a parabola because density grows with depth. `heights` of equal particles, highest first.
double surfaceOf(const std::vector<double>& heights, double radius_m) {
  const double roof = heights[heights.size() / 100];  // height below which the density is almost that of the soil below
  const double top = roof - 2 * radius_m;
  const double bottom = std::max(roof - 20 * radius_m, (roof + heights.back()) / 2);
  // In units of the fitted depth, so that the normal equations are well conditioned.
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vec3 right = Vec3::Zero();
  for (std::size_t above = 0; above < heights.size() && heights[above] >= bottom; ++above) {
    if (heights[above] <= top) {
      const double x = (roof - heights[above]) / (roof - bottom);
      const Vec3 powers(1, x, x * x);
      normal += powers * powers.transpose();
      right += powers * (static_cast<double>(above) + 0.5);
    }
  }
  const Vec3 fit = normal.ldlt().solve(right);
  // The root of c + b x + a x^2 next to 0, in the form that is stable for small a.
  const double root = std::sqrt(std::max(0.0, fit[1] * fit[1] - 4 * fit[2] * fit[0]));
  return roof + 2 * fit[0] / (fit[1] + root) * (roof - bottom);
}

}  // namespace

double SettleResult::meanDensity(double depth) const {
  double mass = 0;
  double covered = 0;
  const double half = slices.front().depth_m;
  for (const SettledSlice& slice : slices) {
    const double share = std::clamp((depth - slice.depth_m + half) / (2 * half), 0.0, 1.0);
    mass += share * slice.density_kg_m3;
    covered += share;
  }
  return mass / covered;
}

void validate(const SettleOptions& options) {
  requireInRange("depth_m", options.depth_m, {0.05, 2});
  requireInRange("width_diameters", options.width_diameters, {6, 1000});
}

SettleResult settleTest(const LabConditions& conditions, const SettleOptions& options) {
  validate(options);
  constexpr double kMostCompaction = 1.45;  // max. compaction of soft soil under its weight, over random packing
  const double side = options.width_diameters * 2 * conditions.soil.radius_m;
  const double area = side * side;
  const LabBox box{.width_m = side, .length_m = side, .periodic_x = true, .periodic_y = true};
  const std::size_t particles = particlesFor(conditions.soil, area * options.depth_m * kMostCompaction);
  LabBed lab(conditions, box, looseSoil(conditions.soil, box, particles, 0, conditions.seed));
  lab.settle(Preparation::kDense, 0);

  // The floor takes up half a diameter of volume, because centres are above it. So the mass above a height is counted.
  std::vector<double> heights;
  for (const Vec3& centre : lab.soilCentres()) {
    heights.push_back(centre.z());
  }
  std::sort(heights.begin(), heights.end(), std::greater<>());
  const double mass = lab.bed().mass();
  const auto mass_above = [&](double z) {
    return mass *
           static_cast<double>(std::lower_bound(heights.begin(), heights.end(), z, std::greater<>()) - heights.begin());
  };
  const double surface = surfaceOf(heights, conditions.soil.radius_m);

  SettleResult result;
  result.depth_m = surface;
  result.time_s = lab.time();
  result.trace.columns = {"depth_m", "density_kg_m3"};
  const double slice = std::max(0.02, 3 * conditions.soil.radius_m);
  const double deepest = surface - 4 * conditions.soil.radius_m;  // the floor orders the layers next to it
  for (double top = 0; top + slice < deepest; top += slice) {
    const double within = mass_above(surface - top - slice) - (top > 0 ? mass_above(surface - top) : 0);
    result.slices.push_back({top + slice / 2, within / (area * slice)});
    result.trace.rows.push_back({top + slice / 2, within / (area * slice)});
  }
  if (result.slices.empty()) {
    throw InvalidParameter("depth_m", fmt::format("{:g}", options.depth_m), "several particle diameters");
  }
  for (const MeasuredBand& band : measuredBands()) {
    if (band.bottom_m <= surface) {
      const double within =
          mass_above(surface - band.bottom_m) - (band.top_m > 0 ? mass_above(surface - band.top_m) : 0);
      result.bands.push_back({band.top_m, band.bottom_m, within / (area * (band.bottom_m - band.top_m))});
    }
  }
  return result;
}

void drawSettle(const OutputFile& path, const LabConditions& conditions, const SettleResult& result, bool lunar,
                std::string_view title) {
  std::vector<std::vector<double>> measured, law, analysed;
  for (const SettledSlice& slice : result.slices) {
    measured.push_back({slice.density_kg_m3, slice.depth_m * 100});
  }
  for (double depth = 0; lunar && depth <= kLunarLawDepthM; depth += 0.005) {
    law.push_back({lunarBulkDensity(depth), depth * 100});
  }
  for (const Layer& layer : analysedLayers(conditions, kLunarLawDepthM)) {
    analysed.push_back({layer.density_kg_m3, layer.depth_m * 100});
  }
  Figure figure(path, 760, 620);
  figure.data("measured", measured);
  figure.data("lunar", law);
  figure.data("analysed", analysed);
  figure.command(fmt::format("set title {}", gnuplotQuoted(title)));
  figure.command(
      "set xlabel 'bulk density / (kg/m^3)'; set ylabel 'depth / cm'; set yrange [60:0]; set grid lc '#dddddd';"
      "set key tmargin center horizontal");
  figure.command(fmt::format(
      "plot {}{}"
      "$measured with linespoints pt 7 ps 0.6 lw 2 lc '#1f6fb4' title 'settled in the laboratory'",
      lunar ? "$lunar with lines lw 3 lc '#999999' title 'measured on the Moon (paper 1)', " : "",
      analysed.empty() ? "" : "$analysed with lines lw 2 dt 2 lc '#d2691e' title 'analysis of layers (paper 6)', "));
  figure.save();
}

}  // namespace haptolith
