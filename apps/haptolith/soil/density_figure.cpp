#include "soil/density_figure.h"

#include <fmt/format.h>

#include <array>
#include <limits>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/figure/figure.h"
#include "haptolith/soil/layers.h"
#include "haptolith/soil/lunar_density.h"
#include "haptolith/soil/presets.h"

namespace haptolith {

namespace {

constexpr double kFigureCmPerM = 100;

// From Okabe and Ito's colours, which colour-blind readers can discriminate.
constexpr std::array<std::string_view, 6> kPresetColours{"#d55e00", "#e69f00", "#009e73",
                                                         "#56b4e9", "#0072b2", "#cc79a7"};

using Rows = std::vector<std::vector<double>>;  // density in kg/m^3, depth in cm

Rows rowsOf(const std::vector<Layer>& layers) {
  Rows rows;
  for (const Layer& layer : layers) {
    rows.push_back({layer.density_kg_m3, layer.depth_m * kFigureCmPerM});
  }
  return rows;
}

/// Adds the curves of one figure and collects gnuplot's plot clauses in order.
class Curves {
 public:
  explicit Curves(Figure& figure) : figure_(figure) {}

  void add(const Rows& rows, std::string_view how) {
    const std::string name = fmt::format("rows{}", clauses_++);
    figure_.data(name, rows);
    plot_ += fmt::format("{}${} {}", plot_.empty() ? "plot " : ", \\\n     ", name, how);
  }

  /// Adds a curve of layers; soil that cannot carry its weight is only in the legend.
  template <class MakeLayers>
  void addLayers(MakeLayers make_layers, const std::string& title, std::string_view line) {
    try {
      add(rowsOf(make_layers()), fmt::format("using 1:2 with lines {} title '{}'", line, title));
    } catch (const Failure&) {
      constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
      add({{kGap, kGap}}, fmt::format("using 1:2 with lines {} title '{} (collapses)'", line, title));
    }
  }

  void plot() { figure_.command(plot_); }

 private:
  Figure& figure_;
  std::string plot_;
  int clauses_ = 0;
};

void addMeasuredBands(Curves& curves) {
  Rows rows;
  for (const MeasuredBand& band : measuredBands()) {
    rows.push_back({band.density_kg_m3, (band.top_m + band.bottom_m) / 2 * kFigureCmPerM,
                    band.density_kg_m3 - band.tolerance_kg_m3, band.density_kg_m3 + band.tolerance_kg_m3,
                    band.top_m * kFigureCmPerM, band.bottom_m * kFigureCmPerM});
  }
  curves.add(rows,
             "using 1:2:3:4:5:6 with xyerrorbars pointtype 7 pointsize 0.6 linewidth 1.5 linecolor rgb '#888888' "
             "title 'measured band means, ±50'");
}

void addLunarLaw(Curves& curves) {
  constexpr int kSteps = 240;
  Rows rows;
  for (int i = 0; i <= kSteps; ++i) {
    const double depth = kLunarLawDepthM * i / kSteps;
    rows.push_back({lunarBulkDensity(depth), depth * kFigureCmPerM});
  }
  curves.add(rows, "using 1:2 with lines linewidth 2.5 dashtype (8,5) linecolor rgb '#000000' title 'lunar law'");
}

void addPresets(Curves& curves, const DensityFigure& wanted) {
  for (std::size_t i = 0; i < presets().size(); ++i) {
    const Preset& preset = presets()[i];
    SoilParameters soil = rescaled(preset.soil, wanted.soil.radius_m);
    soil.stiffness_n_m = wanted.soil.stiffness_n_m;
    const bool emphasised = preset.name == wanted.preset;
    curves.addLayers([&] { return layersToDepth(soil, wanted.gravity_m_s2, kLunarLawDepthM); },
                     fmt::format("{}, μ = {:.3g}", preset.name, preset.friction_coefficient),
                     fmt::format("linewidth {} linecolor rgb '{}'", emphasised ? 4.5 : 1.5, kPresetColours[i]));
  }
}

void addLinearModel(Curves& curves, const DensityFigure& wanted) {
  const SoilParameters soil = rescaled(findPreset(wanted.preset).soil, wanted.soil.radius_m);
  curves.addLayers([&] { return linearLayersToDepth(soil, wanted.gravity_m_s2, kLunarLawDepthM); },
                   fmt::format("linear contact, k = {:.4g} N/m", soil.stiffness_n_m),
                   "linewidth 2.5 dashtype (2,4) linecolor rgb '#7a3b00'");
}

}  // namespace

void drawDensityFigure(const OutputFile& path, const DensityFigure& wanted) {
  Figure figure(path, 1080, 640);
  figure.command(fmt::format(R"(
set xlabel 'bulk density / (kg/m^3)'
set ylabel 'depth below the surface / cm'
set yrange [60:0]
set xrange [1200:*]
set offsets graph 0, graph 0.02, 0, 0
set key outside right center Left reverse samplen 3 spacing 1.25
set title 'Bulk density of regolith under {:.4g} m/s^2, macroparticles of R = {:.4g} mm'
)",
                             wanted.gravity_m_s2, wanted.soil.radius_m * 1e3));
  Curves curves(figure);
  addMeasuredBands(curves);
  addLunarLaw(curves);
  if (wanted.preset.empty()) {
    curves.addLayers([&] { return layersToDepth(wanted.soil, wanted.gravity_m_s2, kLunarLawDepthM); }, "this soil",
                     fmt::format("linewidth 4 linecolor rgb '{}'", kPresetColours[4]));
  } else {
    addLinearModel(curves, wanted);
    addPresets(curves, wanted);
  }
  curves.plot();
  figure.save();
}

}  // namespace haptolith
