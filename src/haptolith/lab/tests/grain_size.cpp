#include "haptolith/lab/tests/grain_size.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/core/error.h"
#include "haptolith/core/statistics.h"
#include "haptolith/figure/figure.h"
#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/lab/staged_progress.h"
#include "haptolith/lab/theory/straight_line.h"

namespace haptolith {

namespace {

constexpr double kGrainMm = 1e-3;
constexpr double kGrainBladeThickness_m = 2e-3;
constexpr double kGrainToolStiffness = 2;  // over that of the contacts: the blade must not deform before they do
constexpr double kSample_s = 1e-3;

// Space around the blade and its path; below it more than two of the coarsest particles.
constexpr double kBehind_m = 0.02, kAhead_m = 0.05, kBeside_m = 0.02, kBelow_m = 0.035;
// Fine region around the blade, which pushes soil ahead and aside.
constexpr double kFineAhead_m = 0.025, kFineBeside_m = 0.01, kFineBelow_m = 0.008;

void validate(const LabConditions& conditions, const GrainSizeOptions& options) {
  const Range positive{0, 1, Ends::kOpenBelow};
  validate(conditions.soil);
  requireInRange("gravity_m_s2", conditions.gravity_m_s2, {0, 1000, Ends::kOpenBelow});
  requireInRange("width_m", options.width_m, {0.005, 1});
  requireInRange("depth_m", options.depth_m, {0.002, 0.2});
  requireInRange("speed_m_s", options.speed_m_s, positive);
  requireInRange("level_m", options.level_m, {0, 10});
  requireInRange("travel_m", options.travel_m, {options.level_m, 10, Ends::kOpenBelow});
  requireInRange("filter_cutoff_hz", options.filter_cutoff_hz, {0, 0.5 / kSample_s, Ends::kOpenBelow});
  requireInRange("specimens", options.specimens, GrainSizeRanges::specimens);
  for (const double radius_m : options.radii_m) {
    requireInRange("radii_m", radius_m, {0.5 * kGrainMm, 20 * kGrainMm});
  }
  if (options.radii_m.empty() && !options.graded) {
    throw InvalidParameter("radii_m", "none", "one size of grain at least");
  }
}

/// Returns the bed; its centre is the centre of the blade's path along x.
BedParameters boxOf(const LabConditions& conditions, const GrainSizeOptions& options, const SoilParameters& soil) {
  BedParameters bed;
  bed.soil = soil;
  bed.gravity_m_s2 = {0, 0, -conditions.gravity_m_s2};
  bed.width_m = kBehind_m + options.travel_m + kAhead_m;
  bed.length_m = options.width_m + 2 * kBeside_m;
  bed.start = BedStart::kSettled;
  bed.depth_m = options.depth_m + kBelow_m;
  bed.threads = conditions.threads;
  bed.max_substeps = static_cast<int>(BedRanges::max_substeps.highest);
  bed.sleep = false;
  return bed;
}

/// Bed with one particle size, or with a grading.
struct Bedding {
  std::string name;
  BedParameters bed;
  double finest_m;
};

std::vector<Bedding> beddings(const LabConditions& conditions, const GrainSizeOptions& options) {
  std::vector<Bedding> all;
  for (const double radius_m : options.radii_m) {
    all.push_back({fmt::format("{:g} mm", radius_m / kGrainMm),
                   boxOf(conditions, options, rescaled(conditions.soil, radius_m)), radius_m});
  }
  if (options.graded) {
    BedParameters bed = boxOf(conditions, options, conditions.soil);
    bed.grading.fine_radius_m = options.fine_radius_m;
    bed.grading.fine_width_m = std::min(options.travel_m + 2 * kFineBeside_m + kFineAhead_m, bed.width_m);
    bed.grading.fine_x_m = (kBehind_m - kAhead_m) / 2 + (kFineAhead_m - kFineBeside_m) / 2;
    bed.grading.fine_width_m = std::min(bed.grading.fine_width_m, bed.width_m - 2 * std::abs(bed.grading.fine_x_m));
    bed.grading.fine_length_m = std::min(options.width_m + 2 * kFineBeside_m, bed.length_m);
    bed.grading.fine_depth_m = options.depth_m + kFineBelow_m;
    all.push_back(
        {fmt::format("graded, {:g} to {:g} mm", conditions.soil.radius_m / kGrainMm, options.fine_radius_m / kGrainMm),
         bed, options.fine_radius_m});
  }
  return all;
}

/// Returns the height of the soil on the blade's path, as seen from above. It does not depend on particle size, unlike
/// the height of the tips.
double surfaceOfWay(const Bed& bed, const GrainSizeOptions& options) {
  constexpr std::size_t kRays = 200;
  const double length_m = options.travel_m;
  const HeightGrid way{.x_m = kBehind_m - bed.parameters().width_m / 2,
                       .y_m = -options.width_m / 2,
                       .cell_m = std::min(length_m, options.width_m),
                       .columns = 1,
                       .rows = 1};
  return surfaceHeights(seenSoil(bed), way, kRays).front();
}

struct Drawn {
  std::size_t particles = 0;
  std::vector<std::vector<double>> trace;  ///< travel_m, draft_n, filtered_n, one row per sample
};

Drawn draw(const LabConditions& conditions, const GrainSizeOptions& options, const BedParameters& parameters,
           std::string_view what) {
  ToolParameters blade;
  blade.shape = ToolShape::kBox;
  blade.size_m = {2 * options.depth_m, options.width_m, kGrainBladeThickness_m};
  blade.stiffness_n_m = kGrainToolStiffness * parameters.soil.stiffness_n_m;
  LabConditions of_specimen = conditions;
  of_specimen.soil = parameters.soil;
  LabBed lab(of_specimen, parameters, blade);

  // Upright, its normal along x; lowered at the start of the path and then drawn.
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  const double surface = surfaceOfWay(lab.bed(), options);
  const double above = 2 * parameters.soil.radius_m;
  lab.placeTool({{kBehind_m - parameters.width_m / 2, 0, surface + above + options.depth_m}, Quat(axes)});
  lab.moveTool({{0, 0, -options.speed_m_s}, Vec3::Zero()});
  lab.run((above + options.depth_m) / options.speed_m_s, what);

  Drawn drawn;
  drawn.particles = lab.soil() - lab.bed().heldParticles();
  lab.moveTool({{options.speed_m_s, 0, 0}, Vec3::Zero()});
  const double share = 1 - std::exp(-2 * std::numbers::pi * options.filter_cutoff_hz * kSample_s);
  double filtered = 0;
  double sum = 0;
  double steps = 0;
  const double begin = lab.time();
  lab.run(options.travel_m / options.speed_m_s, what, [&] {
    sum -= lab.toolWrench().force_n.x();
    ++steps;
    if (lab.time() - begin >= static_cast<double>(drawn.trace.size() + 1) * kSample_s) {
      const double draft = sum / steps;
      filtered += drawn.trace.empty() ? draft : share * (draft - filtered);
      drawn.trace.push_back({(lab.time() - begin) * options.speed_m_s, draft, filtered});
      sum = steps = 0;
    }
  });
  return drawn;
}

/// Mean of a column of a trace within the evaluated range, and its values minus a straight line.
struct Detrended {
  double mean = 0;
  std::vector<double> rest;

  [[nodiscard]] double deviation() const {
    double squares = 0;
    for (const double value : rest) {
      squares += value * value;
    }
    return std::sqrt(squares / static_cast<double>(rest.size()));
  }
};

Detrended detrended(const Drawn& drawn, double level_m, std::size_t column) {
  std::vector<double> travel;
  Detrended result;
  for (const std::vector<double>& row : drawn.trace) {
    if (row[0] >= level_m) {
      travel.push_back(row[0]);
      result.rest.push_back(row[column]);
      result.mean += row[column];
    }
  }
  result.mean /= static_cast<double>(result.rest.size());
  const StraightLine line = fitStraightLine(travel, result.rest);
  for (std::size_t i = 0; i < travel.size(); ++i) {
    result.rest[i] -= line.intercept + line.slope * travel[i];
  }
  return result;
}

/// Returns the periodogram with a Hann window, averaged over bands of an eighth of an octave.
std::vector<GrainSpectrumPoint> spectrumOf(const std::vector<double>& values) {
  const std::size_t n = values.size();
  constexpr double kBand = 1.0905;
  std::vector<GrainSpectrumPoint> bands;
  double in_band = 0;
  GrainSpectrumPoint sum;
  double end_hz = 0;
  for (std::size_t k = 1; k < n / 2; ++k) {
    double re = 0, im = 0, window_power = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double phase = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
      const double window = 0.5 - 0.5 * std::cos(phase);
      re += window * values[i] * std::cos(phase * static_cast<double>(k));
      im += window * values[i] * std::sin(phase * static_cast<double>(k));
      window_power += window * window;
    }
    const double hz = static_cast<double>(k) / (static_cast<double>(n) * kSample_s);
    if (hz > end_hz && in_band > 0) {
      bands.push_back({sum.frequency_hz / in_band, sum.power_n2_per_hz / in_band});
      sum = {};
      in_band = 0;
    }
    if (in_band == 0) {
      end_hz = kBand * hz;
    }
    sum.frequency_hz += hz;
    sum.power_n2_per_hz += 2 * kSample_s * (re * re + im * im) / window_power;
    ++in_band;
  }
  return bands;
}

}  // namespace

std::vector<GrainSizeResult> grainSizeTest(const LabConditions& conditions, const GrainSizeOptions& options) {
  validate(conditions, options);
  const std::vector<Bedding> all = beddings(conditions, options);
  for (const Bedding& bedding : all) {
    validate(bedding.bed);
  }
  std::vector<GrainSizeResult> results;
  StagedProgress progress(conditions.progress);
  LabConditions staged = conditions;
  staged.progress = progress.inner();
  const auto drawings = static_cast<double>(all.size()) * options.specimens;
  double drawn_before = 0;
  for (const Bedding& bedding : all) {
    GrainSizeResult result;
    result.name = bedding.name;
    result.radius_m = bedding.finest_m;
    std::vector<double> means;
    for (int specimen = 0; specimen < options.specimens; ++specimen) {
      BedParameters bed = bedding.bed;
      bed.seed = conditions.seed + static_cast<std::uint64_t>(specimen);
      progress.enter(drawn_before / drawings, (drawn_before + 1) / drawings);
      ++drawn_before;
      const Drawn drawn = draw(staged, options, bed,
                               fmt::format("{}, specimen {} of {}", bedding.name, specimen + 1, options.specimens));
      const Detrended draft = detrended(drawn, options.level_m, 1);
      const Detrended felt = detrended(drawn, options.level_m, 2);
      means.push_back(draft.mean);
      result.variation += felt.deviation() / felt.mean / options.specimens;
      result.unfiltered_variation += draft.deviation() / draft.mean / options.specimens;
      const std::vector<GrainSpectrumPoint> spectrum = spectrumOf(draft.rest);
      result.spectrum.resize(spectrum.size());
      for (std::size_t i = 0; i < spectrum.size(); ++i) {
        result.spectrum[i].frequency_hz = spectrum[i].frequency_hz;
        result.spectrum[i].power_n2_per_hz += spectrum[i].power_n2_per_hz / options.specimens;
      }
      result.particles = drawn.particles;
      if (specimen == 0) {
        result.trace = drawn.trace;
      }
    }
    result.draft_n = mean(means);
    result.draft_sd_n = means.size() > 1 ? standardDeviation(means) : 0;
    results.push_back(std::move(result));
  }
  return results;
}

void drawGrainSize(const OutputFile& file, const std::vector<GrainSizeResult>& results, std::string_view title) {
  constexpr const char* kColours[] = {"#d55e00", "#0072b2", "#009e73", "#cc79a7", "#333333", "#e69f00"};
  Figure figure(file, 900, 900);
  figure.command("set grid linecolor rgb '#dddddd'; set key outside right top");
  figure.command(fmt::format("set multiplot layout 2,1 title {}", gnuplotQuoted(title)));
  const auto plot = [&](const char* data, const char* how) {
    std::string curves;
    for (std::size_t i = 0; i < results.size(); ++i) {
      curves += fmt::format("{}${}{} {} with lines linewidth 2 linecolor rgb '{}' title {}", i == 0 ? "plot " : ", ",
                            data, i, how, kColours[i % std::size(kColours)], gnuplotQuoted(results[i].name));
    }
    return curves;
  };
  for (std::size_t i = 0; i < results.size(); ++i) {
    std::vector<std::vector<double>> spectrum;
    for (const GrainSpectrumPoint& point : results[i].spectrum) {
      spectrum.push_back({point.frequency_hz, point.power_n2_per_hz});
    }
    figure.data(fmt::format("trace{}", i), results[i].trace);
    figure.data(fmt::format("spectrum{}", i), spectrum);
  }
  figure.command("set xlabel 'travel / mm'; set ylabel 'draft through the filter / N'");
  figure.command(plot("trace", "using ($1*1000):3"));
  figure.command(
      "set xlabel 'frequency / Hz'; set ylabel 'power of the draft / (N^2/Hz)'; set logscale xy; set format y "
      "'10^{%L}'");
  figure.command(plot("spectrum", "using 1:2"));
  figure.command("unset multiplot");
  figure.save();
}

}  // namespace haptolith
