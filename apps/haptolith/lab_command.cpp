#include "lab_command.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/lab/calibrate_soil.h"
#include "haptolith/lab/settle.h"
#include "haptolith/lab/shear.h"
#include "haptolith/scenario/scene_words.h"
#include "haptolith/scenario/soil_file.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/lunar_density.h"

#include "lab_options.h"
#include "output.h"
#include "stop_on_signal.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

/// What a test has to say when it is done.
struct LabOutput {
  Json json;
  std::string text;
  LabTrace trace;
  std::function<void(const std::string& path, const std::string& title)> draw;
};

/// Adds `haptolith lab NAME`: `more` adds the test's own options, `test` does the work.
CLI::App* addTest(CLI::App& lab, const std::string& name, const std::string& description, const std::string& examples,
                  const std::shared_ptr<LabOptions>& options,
                  std::function<LabOutput(const LabOptions&, const LabConditions&)> test) {
  CLI::App* command = lab.add_subcommand(name, description);
  options->addTo(*command);
  command->footer("Examples:\n" + examples);
  command->callback([name, options, test = std::move(test)] {
    const StopOnSignal stop_on_signal;
    StatusLine status;
    const LabConditions conditions = labConditions(*options, status);
    const LabOutput output = test(*options, conditions);
    status.clear();
    if (!options->trace_file.empty()) {
      saveTrace(options->trace_file, output.trace);
    }
    if (!options->figure_file.empty()) {
      output.draw(options->figure_file, circumstancesText(*options, conditions));
    }
    if (options->json) {
      Json document = circumstancesJson(*options, conditions);
      document.insert(document.begin(), {"test", name});
      document.update(output.json);
      printJson(document);
    } else {
      printText(fmt::format("lab {}: {}\n\n{}", name, circumstancesText(*options, conditions), output.text));
    }
  });
  return command;
}

// --- haptolith lab settle --------------------------------------------------------------------------------------------

LabOutput settleOutput(const LabConditions& conditions, const SettleOptions& options) {
  const SettleResult result = settleTest(conditions, options);
  Json bands = Json::array();
  Json slices = Json::array();
  std::string text = "  depth / cm   density / (kg/m³)   on the Moon\n";
  for (const SettledBand& band : result.bands) {
    for (const MeasuredBand& measured : measuredBands()) {
      if (measured.top_m == band.top_m && measured.bottom_m == band.bottom_m) {
        bands.push_back({{"top_m", band.top_m},
                         {"bottom_m", band.bottom_m},
                         {"density_kg_m3", band.density_kg_m3},
                         {"measured_kg_m3", measured.density_kg_m3},
                         {"measured_tolerance_kg_m3", measured.tolerance_kg_m3}});
        text += fmt::format("  {:>4.0f} - {:<3.0f}   {:>14.0f}        {:.0f} ± {:.0f}\n", band.top_m * 100,
                            band.bottom_m * 100, band.density_kg_m3, measured.density_kg_m3, measured.tolerance_kg_m3);
      }
    }
  }
  for (const SettledSlice& slice : result.slices) {
    slices.push_back({{"depth_m", slice.depth_m}, {"density_kg_m3", slice.density_kg_m3}});
  }
  return {{{"depth_m", result.depth_m}, {"settled_after_s", result.time_s}, {"bands", bands}, {"slices", slices}},
          text,
          result.trace,
          [conditions, result](const std::string& path, const std::string& title) {
            drawSettle(path, conditions, result, title);
          }};
}

void addSettle(CLI::App& lab) {
  auto options = std::make_shared<LabOptions>();
  auto own = std::make_shared<SettleOptions>();
  CLI::App* command = addTest(lab, "settle", "Density with depth of soil that has settled under its own weight",
                              "  haptolith lab settle\n"
                              "  haptolith lab settle --soil dry-sand --body Earth --figure density.svg",
                              options, [own](const LabOptions&, const LabConditions& conditions) {
                                return settleOutput(conditions, *own);
                              });
  command->add_option("--depth-m", own->depth_m, "depth of the column at least")->capture_default_str();
}

// --- haptolith lab shear ---------------------------------------------------------------------------------------------

LabOutput shearOutput(const LabConditions& conditions, const ShearOptions& options) {
  const ShearResult result = shearTest(conditions, options);
  LabTrace trace{{"specimen", "displacement_m", "shear_pa", "normal_pa", "height_m"}, {}};
  Json points = Json::array();
  std::string text = "  normal / Pa   peak / Pa   residual / Pa   dilation / %\n";
  for (const ShearPointResult& point : result.points) {
    points.push_back({{"normal_pa", point.normal_pa},
                      {"peak_pa", point.peak_pa},
                      {"residual_pa", point.residual_pa},
                      {"dilation", point.dilation}});
    text += fmt::format("  {:>11.0f}   {:>9.0f}   {:>13.0f}   {:>12.1f}\n", point.normal_pa, point.peak_pa,
                        point.residual_pa, 100 * point.dilation);
    for (const std::vector<double>& row : point.trace.rows) {
      trace.rows.push_back({static_cast<double>(points.size() - 1)});
      trace.rows.back().insert(trace.rows.back().end(), row.begin(), row.end());
    }
  }
  const auto line = [](std::string_view what, const MohrCoulomb& fit) {
    return fmt::format("  {:<9} friction angle {:4.1f} ± {:.1f}°, cohesion {:5.0f} ± {:.0f} Pa\n", what,
                       degrees(fit.friction_angle_rad), degrees(fit.friction_angle_se_rad), fit.cohesion_pa,
                       fit.cohesion_se_pa);
  };
  text += "\n" + line("peak", result.peak) + line("residual", result.residual) +
          fmt::format("  bulk density {:.0f} kg/m³ before shearing\n", result.bulk_density_kg_m3);
  return {{{"points", points},
           {"peak_friction_angle_deg", degrees(result.peak.friction_angle_rad)},
           {"peak_cohesion_pa", result.peak.cohesion_pa},
           {"residual_friction_angle_deg", degrees(result.residual.friction_angle_rad)},
           {"residual_friction_angle_se_deg", degrees(result.residual.friction_angle_se_rad)},
           {"cohesion_pa", result.residual.cohesion_pa},
           {"cohesion_se_pa", result.residual.cohesion_se_pa},
           {"bulk_density_kg_m3", result.bulk_density_kg_m3}},
          text,
          trace,
          [result](const std::string& path, const std::string& title) { drawShear(path, result, title); }};
}

void addShear(CLI::App& lab) {
  auto options = std::make_shared<LabOptions>();
  auto own = std::make_shared<ShearOptions>();
  CLI::App* command = addTest(lab, "shear", "Direct shear between rough plates: friction angle and cohesion",
                              "  haptolith lab shear\n"
                              "  haptolith lab shear --soil dry-sand --figure shear.svg\n"
                              "  haptolith lab shear --friction paper --json",
                              options, [own](const LabOptions&, const LabConditions& conditions) {
                                return shearOutput(conditions, *own);
                              });
  command->add_option("--normal-pa", own->normal_stresses_pa, "normal stresses, three or more")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--strain", own->strain, "how far the plate goes over the specimen's height")->capture_default_str();
}

// --- haptolith lab calibrate -----------------------------------------------------------------------------------------

struct CalibrateCommand {
  SoilTarget target;
  double radius_mm = 7;
  std::string body = "Moon";
  std::string name, source, out_file;
  std::uint64_t seed = 1;
  int threads = 0;
  bool json = false;
};

void runCalibrateSoil(const CalibrateCommand& command) {
  const StopOnSignal stop_on_signal;
  StatusLine status;
  LabOptions lab;
  lab.threads = command.threads;
  const LabConditions conditions = labConditions(lab, status);
  CalibrateSoilOptions options;
  requireInRange("radius_mm", command.radius_mm, {0.5, 20});
  options.radius_m = command.radius_mm / 1e3;
  options.gravity_m_s2 = findBody(command.body).gravity_m_s2;
  options.seed = command.seed;
  options.threads = conditions.threads;
  options.progress = conditions.progress;
  const CalibratedSoil result = calibrateSoil(command.target, options);
  status.clear();
  const SoilReached& reached = result.reached;
  if (!command.out_file.empty()) {
    saveSoilFile(command.out_file, {command.name, command.source, command.target, result.soil, reached});
  }
  if (command.json) {
    printJson({{"friction_angle_deg", reached.friction_angle_deg},
               {"friction_angle_sd_deg", reached.friction_angle_sd_deg},
               {"cohesion_pa", reached.cohesion_pa},
               {"cohesion_sd_pa", reached.cohesion_sd_pa},
               {"bulk_density_kg_m3", reached.bulk_density_kg_m3},
               {"seeds", reached.seeds},
               {"rounds", result.rounds},
               {"contact_friction", result.soil.contact_friction},
               {"contact_cohesion_n", result.soil.contact_cohesion_n},
               {"stiffness_n_m", result.soil.stiffness_n_m},
               {"gamma_nm", result.soil.gamma_nm},
               {"rho0_kg_m3", result.soil.rho0_kg_m3},
               {"rho_max_kg_m3", result.soil.rho_max_kg_m3},
               {"radius_mm", command.radius_mm},
               {"out", command.out_file.empty() ? Json(nullptr) : Json(command.out_file)}});
    return;
  }
  printText(fmt::format(
      "                   asked    reached ({} specimens)\n"
      "  friction angle   {:5.1f}°   {:5.1f} ± {:.1f}°\n"
      "  cohesion         {:5.0f}    {:5.0f} ± {:.0f} Pa\n"
      "  bulk density     {:5.0f}    {:5.0f} kg/m³\n\n"
      "  contact friction {:.4f}, contact cohesion {:.4g} N, stiffness {:.4g} N/m\n{}",
      reached.seeds, command.target.friction_angle_deg, reached.friction_angle_deg, reached.friction_angle_sd_deg,
      command.target.cohesion_pa, reached.cohesion_pa, reached.cohesion_sd_pa, command.target.bulk_density_kg_m3,
      reached.bulk_density_kg_m3, result.soil.contact_friction, result.soil.contact_cohesion_n,
      result.soil.stiffness_n_m, command.out_file.empty() ? "" : fmt::format("  saved in {}\n", command.out_file)));
}

void addCalibrate(CLI::App& lab) {
  auto command = std::make_shared<CalibrateCommand>();
  CLI::App* app = lab.add_subcommand(
      "calibrate", "Finds macroparticles whose sheared bed has the wanted friction angle, cohesion and density");
  app->add_option("--friction-angle-deg", command->target.friction_angle_deg, "20 to 52")->required();
  app->add_option("--cohesion-pa", command->target.cohesion_pa, "0 to 4500")->required();
  app->add_option("--bulk-density-kg-m3", command->target.bulk_density_kg_m3, "mean of the upper 15 cm")->required();
  std::map<std::string, SoilStrength> words;
  for (const auto& word : kSoilStrengthWords) {
    words.emplace(word.name, word.value);
  }
  app->add_option("--strength", command->target.strength,
                  "residual: what a moving shovel feels; peak: what undisturbed soil carries at most [residual]")
      ->transform(CLI::CheckedTransformer(words, CLI::ignore_case).description(""));
  app->add_option("--radius-mm", command->radius_mm, "radius of a macroparticle, 0.5 to 20")->capture_default_str();
  app->add_option("--body", command->body, "where the soil has that density")->capture_default_str();
  app->add_option("--out", command->out_file, "soil file to write, for --soil: FILE.toml");
  app->add_option("--name", command->name, "the soil's name in that file [the file's name]");
  app->add_option("--source", command->source, "where the target comes from, for that file");
  app->add_option("--seed", command->seed, "of the specimens")->capture_default_str();
  app->add_option("--threads", command->threads, "threads to use [all]")->check(CLI::Range(1, 256));
  app->add_flag("--json", command->json, "print one JSON object instead of a table");
  app->footer(
      "Example:\n"
      "  haptolith lab calibrate --friction-angle-deg 42 --cohesion-pa 520 --bulk-density-kg-m3 1500 --out soil.toml\n"
      "  haptolith run --soil soil.toml");
  app->callback([command] {
    if (command->name.empty()) {
      command->name = std::filesystem::path(command->out_file).stem().string();
    }
    runCalibrateSoil(*command);
  });
}

}  // namespace

void addLabCommand(CLI::App& app) {
  CLI::App* lab = app.add_subcommand("lab", "A soil laboratory: what a bed of macroparticles really does");
  lab->require_subcommand(1);
  lab->footer("Example:\n  haptolith lab shear --soil lunar-0-15cm\nEvery test explains itself with --help.");
  addSettle(*lab);
  addShear(*lab);
  addCalibrate(*lab);
}

}  // namespace haptolith
