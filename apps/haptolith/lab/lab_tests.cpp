#include "lab/lab_tests.h"

#include <CLI/App.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <optional>

#include "haptolith/lab/blade.h"
#include "haptolith/lab/carry.h"
#include "haptolith/lab/cone.h"
#include "haptolith/lab/cut.h"
#include "haptolith/lab/fall.h"
#include "haptolith/lab/findings.h"
#include "haptolith/lab/funnel.h"
#include "haptolith/lab/grain.h"
#include "haptolith/lab/plate.h"
#include "haptolith/lab/repose.h"
#include "haptolith/lab/settle.h"
#include "haptolith/lab/shear.h"
#include "haptolith/soil/lunar_density.h"

#include "shared/option_checks.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kMm = 1e-3;

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

/// An option in mm for a length in m.
void addMm(CLI::App& command, const std::string& name, double& length_m, const std::string& help) {
  command.add_option_function<double>(
      name, [&length_m](double mm) { length_m = mm * kMm; }, fmt::format("{} [{:g}]", help, length_m / kMm));
}

void addDegrees(CLI::App& command, const std::string& name, double& angle_rad, const std::string& help) {
  command.add_option_function<double>(
      name, [&angle_rad](double deg) { angle_rad = radians(deg); },
      fmt::format("{} [{:.3g}]", help, degrees(angle_rad)));
}

void addPreparation(CLI::App& command, Preparation& preparation) {
  const std::map<std::string, Preparation> words{{"dense", Preparation::kDense}, {"loose", Preparation::kLoose}};
  command.add_option("--preparation", preparation, "of the soil: dense, as if shaken, or loose, as if poured [dense]")
      ->transform(wordOf(words).description(""));
}

// --- settle ----------------------------------------------------------------------------------------------------------

LabOutput settleOutput(const LabSoil& soil, const LabConditions& conditions, const SettleOptions& options) {
  const SettleResult result = settleTest(conditions, options);
  LabOutput output;
  Json bands = Json::array();
  Json slices = Json::array();
  const bool lunar = isLunar(conditions.gravity_m_s2, soil.target);
  output.findings = findings(result, conditions.gravity_m_s2, soil.target);
  output.text = "  depth / cm   density / (kg/m³)   should be\n";
  for (std::size_t i = 0; i < result.bands.size(); ++i) {
    const SettledBand& band = result.bands[i];
    bands.push_back({{"top_m", band.top_m}, {"bottom_m", band.bottom_m}, {"density_kg_m3", band.density_kg_m3}});
    for (const MeasuredBand& measured : measuredBands()) {
      if (lunar && measured.top_m == band.top_m && measured.bottom_m == band.bottom_m) {
        bands.back()["measured_kg_m3"] = measured.density_kg_m3;
        bands.back()["measured_tolerance_kg_m3"] = measured.tolerance_kg_m3;
      }
    }
    output.text += fmt::format("  {:>4.0f} - {:<3.0f}   {:>14.0f}        {}\n", band.top_m * 100, band.bottom_m * 100,
                               band.density_kg_m3, output.findings[i].target);
  }
  for (const SettledSlice& slice : result.slices) {
    slices.push_back({{"depth_m", slice.depth_m}, {"density_kg_m3", slice.density_kg_m3}});
  }
  output.json = {{"depth_m", result.depth_m}, {"settled_after_s", result.time_s}, {"bands", bands}, {"slices", slices}};
  output.trace = result.trace;
  output.draw = [conditions, result, lunar](const OutputFile& path, const std::string& title) {
    drawSettle(path, conditions, result, lunar, title);
  };
  return output;
}

LabTest settle() {
  auto own = std::make_shared<SettleOptions>();
  return {.name = "settle",
          .description = "Density with depth of soil that has settled under its own weight",
          .examples =
              "  haptolith lab settle\n"
              "  haptolith lab settle --soil dry-sand --body Earth --figure density.svg",
          .add_options =
              [own](CLI::App& command) {
                command.add_option("--depth-m", own->depth_m, "depth of the column at least")->capture_default_str();
              },
          .run = [own](const LabSoil& soil,
                       const LabConditions& conditions) { return settleOutput(soil, conditions, *own); }};
}

// --- shear -----------------------------------------------------------------------------------------------------------

LabOutput shearOutput(const LabSoil& soil, const LabConditions& conditions, const ShearOptions& options) {
  const ShearResult result = shearTest(conditions, options);
  LabOutput output;
  output.trace.columns = {"specimen", "displacement_m", "shear_pa", "normal_pa", "height_m"};
  Json points = Json::array();
  output.text = "  normal / Pa   peak / Pa   residual / Pa   dilation / %\n";
  for (const ShearPointResult& point : result.points) {
    for (const std::vector<double>& row : point.trace.rows) {
      output.trace.rows.push_back({static_cast<double>(points.size())});
      output.trace.rows.back().insert(output.trace.rows.back().end(), row.begin(), row.end());
    }
    points.push_back({{"normal_pa", point.normal_pa},
                      {"peak_pa", point.peak_pa},
                      {"residual_pa", point.residual_pa},
                      {"dilation", point.dilation}});
    output.text += fmt::format("  {:>11.0f}   {:>9.0f}   {:>13.0f}   {:>12.1f}\n", point.normal_pa, point.peak_pa,
                               point.residual_pa, 100 * point.dilation);
  }
  const auto line = [](std::string_view what, const MohrCoulomb& fit) {
    const bool is_scatter = fit.cohesion_pa < 0 && -fit.cohesion_pa <= 2 * fit.cohesion_se_pa;
    return fmt::format("  {:<9} friction angle {:4.1f} ± {:.1f}°, cohesion {:5.0f} ± {:.0f} Pa{}\n", what,
                       degrees(fit.friction_angle_rad), degrees(fit.friction_angle_se_rad),
                       is_scatter ? 0 : fit.cohesion_pa, fit.cohesion_se_pa,
                       is_scatter ? fmt::format(" (within error: the line meets {:.0f})", fit.cohesion_pa) : "");
  };
  output.text += "\n" + line("peak", result.peak) + line("residual", result.residual) +
                 fmt::format("  bulk density {:.0f} kg/m³ before shearing\n", result.bulk_density_kg_m3);
  output.json = {{"points", points},
                 {"peak_friction_angle_deg", degrees(result.peak.friction_angle_rad)},
                 {"peak_cohesion_pa", result.peak.cohesion_pa},
                 {"residual_friction_angle_deg", degrees(result.residual.friction_angle_rad)},
                 {"residual_friction_angle_se_deg", degrees(result.residual.friction_angle_se_rad)},
                 {"cohesion_pa", result.residual.cohesion_pa},
                 {"cohesion_se_pa", result.residual.cohesion_se_pa},
                 {"bulk_density_kg_m3", result.bulk_density_kg_m3}};
  output.findings = findings(result, soil.target);
  output.draw = [result](const OutputFile& path, const std::string& title) { drawShear(path, result, title); };
  return output;
}

LabTest shear() {
  auto own = std::make_shared<ShearOptions>();
  return {.name = "shear",
          .description = "Direct shear between rough plates: friction angle and cohesion",
          .examples =
              "  haptolith lab shear\n"
              "  haptolith lab shear --soil dry-sand --figure shear.svg\n"
              "  haptolith lab shear --friction paper --json\n"
              "  haptolith lab shear --sizes 2",
          .add_options =
              [own](CLI::App& command) {
                command.add_option("--normal-pa", own->normal_stresses_pa, "normal stresses, three or more")
                    ->delimiter(',')
                    ->capture_default_str();
                command.add_option("--strain", own->strain, "how far the plate goes over the specimen's height")
                    ->capture_default_str();
                command
                    .add_option("--sizes", own->grain_classes,
                                "how many sizes of grain are mixed, a like volume of each: R, R/2, and so on")
                    ->check(wholeNumberIn({1, GrainClasses::kMost}))
                    ->capture_default_str();
              },
          .run = [own](const LabSoil& soil,
                       const LabConditions& conditions) { return shearOutput(soil, conditions, *own); }};
}

// --- repose ----------------------------------------------------------------------------------------------------------

LabOutput reposeOutput(const LabSoil& soil, const LabConditions& conditions, const ReposeOptions& options) {
  const ReposeResult result = reposeTest(conditions, options);
  LabOutput output;
  Json rings = Json::array();
  for (const HeapRing& ring : result.profile.rings) {
    rings.push_back({{"radius_m", ring.radius_m}, {"height_m", ring.height_m}});
  }
  output.text = fmt::format("  angle of repose {:.1f} ± {:.1f}°\n  heap {:.0f} mm high, {} particles\n",
                            degrees(result.angle_rad), degrees(result.angle_se_rad), result.height_m / kMm,
                            result.centres_m.size());
  output.json = {{"angle_deg", degrees(result.angle_rad)},
                 {"angle_se_deg", degrees(result.angle_se_rad)},
                 {"height_m", result.height_m},
                 {"particles", result.centres_m.size()},
                 {"profile", rings}};
  output.findings = findings(result, soil.target);
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawRepose(path, result, title); };
  return output;
}

LabTest repose() {
  auto own = std::make_shared<ReposeOptions>();
  return {
      .name = "repose",
      .description = "A tube of soil lifted off a rough floor: angle of repose",
      .examples =
          "  haptolith lab repose --soil dry-sand --body Earth --figure heap.png\n"
          "  haptolith lab repose --soil dry-sand --body Ceres",
      .radius_mm = 3,  // larger ones are too soft for Earth's gravity: 25.6 instead of 27.1 degrees for dry-sand
      .without_cohesion = true,
      .add_options =
          [own](CLI::App& command) {
            command.add_option("--tube-radius", own->tube_radius, "in radii of a particle")->capture_default_str();
            command.add_option("--fill", own->fill, "height of the soil in the tube, in radii")->capture_default_str();
          },
      .run = [own](const LabSoil& soil,
                   const LabConditions& conditions) { return reposeOutput(soil, conditions, *own); }};
}

// --- cut -------------------------------------------------------------------------------------------------------------

LabOutput cutOutput(const LabSoil& soil, const LabConditions& conditions, const CutOptions& options) {
  const CutResult result = verticalCutTest(conditions, options);
  LabOutput output;
  output.text =
      fmt::format("  a vertical cut of {:.0f} mm {}\n  {:.0f} % of its height is left, its toe went {:.0f} mm ahead\n",
                  options.height_m / kMm, result.stands ? "stands" : "does not stand", 100 * result.height_kept,
                  result.toe_ahead_m / kMm);
  output.json = {{"height_m", options.height_m},
                 {"stands", result.stands},
                 {"height_kept", result.height_kept},
                 {"crest_back_m", result.crest_back_m},
                 {"toe_ahead_m", result.toe_ahead_m}};
  output.findings = findings(result, options.height_m, soil.target);
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawCut(path, result, title); };
  return output;
}

LabTest cut() {
  auto own = std::make_shared<CutOptions>();
  return {
      .name = "cut",
      .description = "A vertical cut whose support is taken away: does it stand?",
      .examples =
          "  haptolith lab cut\n"
          "  haptolith lab cut --soil dry-sand --figure cut.png",
      .add_options = [own](CLI::App& command) { addMm(command, "--height-mm", own->height_m, "of the cut"); },
      .run = [own](const LabSoil& soil, const LabConditions& conditions) { return cutOutput(soil, conditions, *own); }};
}

// --- plate and cone --------------------------------------------------------------------------------------------------

LabOutput plateOutput(const LabConditions& conditions, const PlateOptions& options) {
  const PlateResult result = plateTest(conditions, options);
  LabOutput output;
  Json curve = Json::array();
  output.text = "  sinkage / mm   force / N\n";
  for (std::size_t i = 0; i < result.curve.size(); ++i) {
    const PushReading& reading = result.curve[i];
    curve.push_back({{"sinkage_m", reading.depth_m}, {"force_n", reading.force_n}});
    if (i % 6 == 0) {
      output.text += fmt::format("  {:>12.1f}   {:>9.3g}\n", reading.depth_m / kMm, reading.force_n);
    }
  }
  output.text += fmt::format("\n  p = k z^n: k = {:.4g} Pa/m^n, n = {:.2f}; bulk density {:.0f} kg/m³\n",
                             result.fit.modulus, result.fit.exponent, result.bulk_density_kg_m3);
  output.json = {{"plate_diameter_mm", options.diameter_m / kMm},
                 {"curve", curve},
                 {"exponent", result.fit.exponent},
                 {"modulus", result.fit.modulus},
                 {"bulk_density_kg_m3", result.bulk_density_kg_m3},
                 {"particles", result.particles}};
  output.findings = findings(result, options.diameter_m);
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawPlate(path, result, title); };
  return output;
}

LabTest plate() {
  auto own = std::make_shared<PlateOptions>();
  return {.name = "plate",
          .description = "A flat plate pushed in: pressure against sinkage",
          .examples = "  haptolith lab plate --soil dry-sand --body Earth --plate-diameter-mm 60 --max-sinkage-mm 20",
          .radius_mm = 3.5,
          .add_options =
              [own](CLI::App& command) {
                addMm(command, "--plate-diameter-mm", own->diameter_m, "diameter of the plate");
                addMm(command, "--max-sinkage-mm", own->max_sinkage_m, "how deep it goes");
                addPreparation(command, own->preparation);
              },
          .run = [own](const LabSoil&, const LabConditions& conditions) { return plateOutput(conditions, *own); }};
}

LabOutput coneOutput(const LabConditions& conditions, const ConeOptions& options) {
  const ConeResult result = coneTest(conditions, options);
  LabOutput output;
  Json curve = Json::array();
  output.text = "  depth / mm   resistance / kPa\n";
  for (std::size_t i = 0; i < result.curve.size(); ++i) {
    const ConePoint& point = result.curve[i];
    curve.push_back({{"depth_m", point.depth_m}, {"resistance_pa", point.resistance_pa}});
    if (i % 5 == 0) {
      output.text += fmt::format("  {:>10.1f}   {:>16.3g}\n", point.depth_m / kMm, point.resistance_pa / 1e3);
    }
  }
  output.text += fmt::format("\n  cone index {:.3g} kPa, gradient {:.3g} kPa/m; bulk density {:.0f} kg/m³\n",
                             result.cone_index_pa / 1e3, result.gradient_pa_m / 1e3, result.bulk_density_kg_m3);
  output.json = {{"curve", curve},
                 {"cone_index_pa", result.cone_index_pa},
                 {"gradient_pa_m", result.gradient_pa_m},
                 {"bulk_density_kg_m3", result.bulk_density_kg_m3},
                 {"particles", result.particles}};
  output.findings = findings(result);
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawCone(path, result, title); };
  return output;
}

LabTest cone() {
  auto own = std::make_shared<ConeOptions>();
  return {.name = "cone",
          .description = "A cone penetrometer: resistance against depth",
          .examples = "  haptolith lab cone --figure cone.svg",
          .radius_mm = 3,
          .add_options =
              [own](CLI::App& command) {
                addMm(command, "--cone-diameter-mm", own->base_diameter_m, "diameter of the cone's base");
                addMm(command, "--max-depth-mm", own->max_depth_m, "how deep the base goes");
                addPreparation(command, own->preparation);
              },
          .run = [own](const LabSoil&, const LabConditions& conditions) { return coneOutput(conditions, *own); }};
}

// --- blade -----------------------------------------------------------------------------------------------------------

LabOutput bladeOutput(const LabSoil& soil, const LabConditions& conditions, BladeOptions options, bool own_strength) {
  if (!own_strength) {
    const MohrCoulomb strength = strengthBeforeBlade(conditions, options.preparation);
    options.friction_angle_rad = std::clamp(strength.friction_angle_rad, radians(5), radians(59));
    options.cohesion_pa = std::max(0.0, strength.cohesion_pa);
  }
  const BladeResult result = bladeTest(conditions, options);
  LabOutput output;
  output.text = fmt::format(
      "                 measured           earthmoving equation\n"
      "  draft / N      {:7.3g} ± {:.2g}    {:7.3g}\n"
      "  downwards / N  {:7.3g} ± {:.2g}    {:7.3g}\n\n"
      "  {:.0f} mm wide, {:.1f} mm deep, bulk density {:.0f} kg/m³, {} particles\n"
      "  the equation gets {:.1f}° and {:.0f} Pa\n",
      result.draft_n, result.draft_se_n, result.earthmoving_draft_n, result.vertical_n, result.vertical_se_n,
      result.earthmoving_vertical_n, result.width_m / kMm, result.depth_m / kMm, result.bulk_density_kg_m3,
      result.particles, degrees(options.friction_angle_rad), options.cohesion_pa);
  output.json = {{"width_mm", result.width_m / kMm},
                 {"depth_mm", result.depth_m / kMm},
                 {"rake_deg", degrees(options.rake_rad)},
                 {"draft_n", result.draft_n},
                 {"draft_se_n", result.draft_se_n},
                 {"vertical_n", result.vertical_n},
                 {"vertical_se_n", result.vertical_se_n},
                 {"earthmoving_draft_n", result.earthmoving_draft_n},
                 {"earthmoving_vertical_n", result.earthmoving_vertical_n},
                 {"preparation", options.preparation == Preparation::kLoose ? "loose" : "dense"},
                 {"friction_angle_deg", degrees(options.friction_angle_rad)},
                 {"cohesion_pa", options.cohesion_pa},
                 {"bulk_density_kg_m3", result.bulk_density_kg_m3},
                 {"particles", result.particles}};
  output.findings = findings(result, soil.target);
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawBlade(path, result, title); };
  return output;
}

LabTest blade() {
  auto own = std::make_shared<BladeOptions>();
  auto own_strength = std::make_shared<bool>(false);
  return {.name = "blade",
          .description = "A blade drawn at constant depth: draft, against the earthmoving equation",
          .examples =
              "  haptolith lab blade --width-mm 50 --depth-mm 30 --rake-deg 90\n"
              "  haptolith lab blade --soil dry-sand --friction-angle-deg 35 --soil-cohesion-pa 0",
          .radius_mm = 3,
          .add_options =
              [own, own_strength](CLI::App& command) {
                addMm(command, "--width-mm", own->width_m, "width of the blade");
                addMm(command, "--depth-mm", own->depth_m, "depth of its lower edge");
                addDegrees(command, "--rake-deg", own->rake_rad, "angle between blade and path");
                addPreparation(command, own->preparation);
                command.add_option_function<double>(
                    "--friction-angle-deg",
                    [own, own_strength](double deg) {
                      own->friction_angle_rad = radians(deg);
                      *own_strength = true;
                    },
                    "for the equation [measured by shearing the soil: its peak, or its residual when loose]");
                command.add_option("--soil-cohesion-pa", own->cohesion_pa,
                                   "for the equation, with --friction-angle-deg");
              },
          .run = [own, own_strength](
                     const LabSoil& soil,
                     const LabConditions& conditions) { return bladeOutput(soil, conditions, *own, *own_strength); }};
}

// --- grain -----------------------------------------------------------------------------------------------------------

LabOutput grainOutput(const LabConditions& conditions, const GrainOptions& options) {
  const std::vector<GrainResult> results = grainTest(conditions, options);
  LabOutput output;
  Json sizes = Json::array();
  output.text = "  grains                   number   draft / N   variation / %   without the filter / %\n";
  output.trace.columns = {"finest_radius_m", "travel_m", "draft_n", "filtered_n"};
  for (const GrainResult& result : results) {
    output.text +=
        fmt::format("  {:<22} {:>8}   {:>5.2f} ± {:<4.2f}   {:>7.1f}         {:>7.1f}\n", result.name, result.particles,
                    result.draft_n, result.draft_sd_n, 100 * result.variation, 100 * result.unfiltered_variation);
    Json spectrum = Json::array();
    for (const GrainSpectrumPoint& point : result.spectrum) {
      spectrum.push_back({{"frequency_hz", point.frequency_hz}, {"power_n2_per_hz", point.power_n2_per_hz}});
    }
    sizes.push_back({{"name", result.name},
                     {"finest_radius_m", result.radius_m},
                     {"particles", result.particles},
                     {"draft_n", result.draft_n},
                     {"draft_sd_n", result.draft_sd_n},
                     {"variation", result.variation},
                     {"unfiltered_variation", result.unfiltered_variation},
                     {"spectrum", spectrum}});
    for (const std::vector<double>& row : result.trace) {
      output.trace.rows.push_back({result.radius_m, row[0], row[1], row[2]});
    }
  }
  output.text += fmt::format(
      "\n  ±: from specimen to specimen. variation: standard deviation of the draft about a straight line, over its "
      "mean,\n"
      "  through a low-pass of {:g} Hz as a hand feels it. A hand tells forces apart from about {:.0f} %.\n",
      options.filter_cutoff_hz, 100 * kForceJnd);
  output.json = {{"sizes", sizes}};
  output.draw = [results](const OutputFile& path, const std::string& title) { drawGrain(path, results, title); };
  return output;
}

LabTest grain() {
  auto own = std::make_shared<GrainOptions>();
  return {
      .name = "grain",
      .description = "A blade drawn through grains of several sizes: how rough the force is that a hand feels",
      .examples =
          "  haptolith lab grain --figure grain.png\n"
          "  haptolith lab grain --radii-mm 7,3.5 --no-graded --specimens 1",
      .in_report = false,
      .add_options =
          [own](CLI::App& command) {
            command
                .add_option_function<std::vector<double>>(
                    "--radii-mm",
                    [own](const std::vector<double>& radii_mm) {
                      own->radii_m.clear();
                      for (const double mm : radii_mm) {
                        own->radii_m.push_back(mm * kMm);
                      }
                    },
                    "of beds with grains all alike [7,3.5,2,1.75]")
                ->delimiter(',');
            command.add_flag_callback(
                "--no-graded", [own] { own->graded = false; }, "leave out the bed with grains of several sizes");
            addMm(command, "--fine-radius-mm", own->fine_radius_m, "of the finest grains of that bed");
            addMm(command, "--width-mm", own->width_m, "width of the blade");
            addMm(command, "--depth-mm", own->depth_m, "depth of its lower edge");
            command.add_option("--speed-m-s", own->speed_m_s, "of the blade")->capture_default_str();
            command.add_option("--specimens", own->specimens, "beds of each size")->capture_default_str();
          },
      .run = [own](const LabSoil& /*soil*/, const LabConditions& conditions) { return grainOutput(conditions, *own); }};
}

// --- funnel ----------------------------------------------------------------------------------------------------------

LabOutput funnelOutput(const LabConditions& conditions, const FunnelOptions& options) {
  const FunnelResult result = funnelTest(conditions, options);
  LabOutput output;
  const double d = result.particle_diameter_m;
  Json points = Json::array();
  Json clogged = Json::array();
  output.text = "  opening / d   rate / (g/s)\n";
  for (const FunnelPoint& point : result.points) {
    points.push_back({{"opening_m", point.opening_m},
                      {"opening_diameters", point.opening_m / d},
                      {"rate_kg_s", point.rate_kg_s},
                      {"clogged", point.clogged}});
    output.text += fmt::format("  {:>11.1f}   {:>12}\n", point.opening_m / d,
                               point.clogged ? "clogged" : fmt::format("{:.3g}", point.rate_kg_s * 1e3));
    if (point.clogged) {
      clogged.push_back(point.opening_m / d);
    }
  }
  const bool has_exponent = result.hasExponent();
  output.text += has_exponent
                     ? fmt::format("\n  rate grows with the opening to the power of {:.2f} ± {:.2f}\n",
                                   result.fit.exponent, result.fit.exponent_se)
                     : "\n  too few wide openings ran for a power of the opening; soil with cohesion arches over "
                       "all of them: try one without (dry-sand), or stronger gravity\n";
  output.json = {{"exponent", has_exponent ? Json(result.fit.exponent) : Json(nullptr)},
                 {"exponent_se", has_exponent ? Json(result.fit.exponent_se) : Json(nullptr)},
                 {"clogged", clogged},
                 {"points", points}};
  output.findings = findings(result);
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawFunnel(path, result, title); };
  return output;
}

LabTest funnel() {
  auto own = std::make_shared<FunnelOptions>();
  return {.name = "funnel",
          .description = "Discharge through openings: Beverloo's exponent, clogging",
          .examples =
              "  haptolith lab funnel --soil dry-sand --body Earth\n"
              "  haptolith lab funnel --opening 2,4,6,8,10",
          .without_cohesion = true,
          .add_options =
              [own](CLI::App& command) {
                command.add_option("--opening", own->openings, "openings, in particle diameters")
                    ->delimiter(',')
                    ->capture_default_str();
                command.add_option("--fill", own->fill_openings, "height of the soil over the width of the opening")
                    ->capture_default_str();
              },
          .run = [own](const LabSoil&, const LabConditions& conditions) { return funnelOutput(conditions, *own); }};
}

// --- carry and fall --------------------------------------------------------------------------------------------------

/// To be shown with so many digits: never as -0.
double rounded(double value, int digits) {
  const double scale = std::pow(10, digits);
  return std::round(value * scale) / scale + 0.0;
}

LabOutput carryOutput(const LabConditions& conditions, const CarryOptions& options) {
  const CarryResult result = carryTest(conditions, options);
  LabOutput output;
  output.text = fmt::format(
      "  weight felt / weight       {:.3f}\n"
      "  drag felt / weight         {:.3f}\n"
      "  inertia felt / inertia     {:.3f}\n"
      "  soil goes with the shovel  {:.0f} %\n\n"
      "  {:.0f} g carried, {:.0f} g left at the end\n",
      rounded(result.weight_ratio, 3), rounded(result.drag_ratio, 3), rounded(result.shake_ratio, 3),
      rounded(100 * result.follow_ratio, 0), result.carried_kg * 1e3, result.left_kg * 1e3);
  output.json = {{"weight_ratio", result.weight_ratio}, {"drag_ratio", result.drag_ratio},
                 {"shake_ratio", result.shake_ratio},   {"follow_ratio", result.follow_ratio},
                 {"carried_kg", result.carried_kg},     {"left_kg", result.left_kg}};
  output.findings = findings(result);
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawCarry(path, result, title); };
  return output;
}

LabTest carry() {
  auto own = std::make_shared<CarryOptions>();
  return {.name = "carry",
          .description = "A loaded shovel, still, moved and shaken: weight and drag felt",
          .examples = "  haptolith lab carry\n  haptolith lab carry --friction paper",
          .add_options =
              [own](CLI::App& command) {
                command.add_option("--particles", own->particles, "dropped on the shovel")->capture_default_str();
                command.add_option("--speed-m-s", own->speed_m_s, "sideways")->capture_default_str();
              },
          .run = [own](const LabSoil&, const LabConditions& conditions) { return carryOutput(conditions, *own); }};
}

LabOutput fallOutput(const LabConditions& conditions, const FallOptions& options) {
  const FallResult result = fallTest(conditions, options);
  LabOutput output;
  output.text =
      fmt::format("  acceleration / g   {:.5f}   ({} particles)\n", result.acceleration_ratio, result.particles);
  output.json = {{"acceleration_ratio", result.acceleration_ratio}, {"particles", result.particles}};
  output.findings = findings(result);
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawFall(path, result, title); };
  return output;
}

LabTest fall() {
  auto own = std::make_shared<FallOptions>();
  return {.name = "fall",
          .description = "A clump in free fall: acceleration over g",
          .examples = "  haptolith lab fall\n  haptolith lab fall --friction paper",
          .add_options =
              [own](CLI::App& command) {
                command.add_option("--fall-m", own->fall_m, "height it falls")->capture_default_str();
              },
          .run = [own](const LabSoil&, const LabConditions& conditions) { return fallOutput(conditions, *own); }};
}

}  // namespace

std::vector<LabTest> labTests() {
  return {settle(), shear(), repose(), cut(), plate(), cone(), blade(), funnel(), carry(), fall(), grain()};
}

}  // namespace haptolith
