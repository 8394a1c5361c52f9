#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/catalogue/lab_test.h"
#include "haptolith/lab/report/calibrate_soil.h"
#include "haptolith/lab/report/findings.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/soil/bodies.h"

#include "commands.h"
#include "lab/lab_options.h"
#include "lab/specimens.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/progress.h"
#include "shared/stop_on_signal.h"
#include "workbench_commands.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

struct CalibrateCommand {
  SoilTarget target;
  double radius_mm = 7;
  double stiffness_n_m = 0;
  double max_pressure_kpa = CalibrateSoilOptions{}.max_pressure_pa / 1e3;
  DensityProfile density = DensityProfile::kLunar;
  std::string body = "Moon";
  std::string name, source, out_file;
  std::uint64_t seed = 1;
  int threads = 0;
  int specimens = CalibrateSoilOptions{}.verification_seeds;
  Overwrite overwrite;
  bool json = false;
};

/// Returns a calibration as a specimen of a test named `calibrate`, for `lab collect`: target, seed and result.
Json calibrationJson(const CalibrateCommand& command, const CalibrateSoilOptions& asked, const CalibratedSoil& result) {
  const SoilReached& reached = result.reached;
  LabOutput output;
  output.findings = findings(reached, command.target);
  output.json = {{"friction_angle_deg", reached.friction_angle_deg},
                 {"friction_angle_sd_deg", reached.friction_angle_sd_deg},
                 {"cohesion_pa", reached.cohesion_pa},
                 {"cohesion_sd_pa", reached.cohesion_sd_pa},
                 {"bulk_density_kg_m3", reached.bulk_density_kg_m3},
                 {"rounds", result.rounds},
                 {"contact_friction", result.soil.contact_friction},
                 {"contact_cohesion_n", result.soil.contact_cohesion_n},
                 {"gamma_nm", result.soil.gamma_nm},
                 {"rho0_kg_m3", result.soil.rho0_kg_m3},
                 {"rho_max_kg_m3", result.soil.rho_max_kg_m3},
                 {"out", command.out_file.empty() ? Json(nullptr) : Json(command.out_file)}};
  LabOptions lab;
  lab.body = command.body;
  const LabSoil wanted{fmt::format("{:g}°, {:g} Pa, {:g} kg/m³", command.target.friction_angle_deg,
                                   command.target.cohesion_pa, command.target.bulk_density_kg_m3),
                       result.soil, command.target};
  const LabConditions conditions{result.soil, asked.gravity_m_s2, asked.seed};
  Json json = specimenJson("calibrate", lab, wanted, conditions, output,
                           {{"density", command.density == DensityProfile::kLunar ? "lunar" : "constant"},
                            {"specimens", fmt::format("{}", asked.verification_seeds)}});
  json["soil_keys"] = Json::object();  // the keys of the resulting soil are not conditions
  return json;
}

/// Estimates the seconds on one thread: four rounds of two shear tests, those of the verification, and columns for the
/// density.
double typicalDuration(const CalibrateSoilOptions& options) {
  return (8 + options.verification_seeds) * labTest("shear").typical_s + 2 * labTest("settle").typical_s;
}

void runCalibrateSoil(const CalibrateCommand& command) {
  const StopOnSignal stop_on_signal;
  StatusLine status;
  Progress progress(status);
  requireWritable({command.overwrite(command.out_file)});
  CalibrateSoilOptions options;
  requireInRange("radius_mm", command.radius_mm, {0.5, 20});
  options.radius_m = command.radius_mm / 1e3;
  options.stiffness_n_m = command.stiffness_n_m;
  requireInRange("max_pressure_kpa", command.max_pressure_kpa, {0.1, 1000});
  options.max_pressure_pa = command.max_pressure_kpa * 1e3;
  options.density = command.density;
  options.gravity_m_s2 = findBody(command.body).gravity_m_s2;
  options.seed = command.seed;
  options.threads = threadsFor(command.threads);
  options.progress = progress.part(0, 1);
  options.verification_seeds = command.specimens;
  progress.expect(typicalDuration(options), options.threads);
  const CalibratedSoil result = calibrateSoil(command.target, options);
  status.clear();
  const SoilReached& reached = result.reached;
  if (!command.out_file.empty()) {
    const OutputFile out = command.overwrite(command.out_file);
    const std::filesystem::path made = temporaryBeside(out.path, "part");
    saveSoilFile(made, {command.name, command.source, command.target, result.soil, reached});
    giveName(made, out.path, out.if_there);
  }
  if (command.json) {
    printJson(calibrationJson(command, options, result));
    return;
  }
  printText(
      fmt::format("                   asked    reached ({} specimens)\n"
                  "  friction angle   {:5.1f}°   {:5.1f} ± {:.1f}°\n"
                  "  cohesion         {:5.0f}    {:5.0f} ± {:.0f} Pa\n"
                  "  bulk density     {:5.0f}    {:5.0f} kg/m³\n\n"
                  "  contact friction {:.4f}, contact cohesion {:.4g} N, stiffness {:.4g} N/m\n",
                  reached.seeds, command.target.friction_angle_deg, reached.friction_angle_deg,
                  reached.friction_angle_sd_deg, command.target.cohesion_pa, reached.cohesion_pa,
                  reached.cohesion_sd_pa, command.target.bulk_density_kg_m3, reached.bulk_density_kg_m3,
                  result.soil.contact_friction, result.soil.contact_cohesion_n, result.soil.stiffness_n_m));
}

}  // namespace

void addSoilCalibrateCommand(CLI::App& soil) {
  auto command = std::make_shared<CalibrateCommand>();
  CLI::App* app = soil.add_subcommand("calibrate", kSoilCalibrateDescription);
  app->add_option("--friction-angle-deg", command->target.friction_angle_deg, "Friction angle in degrees, 20 to 52")
      ->required();
  app->add_option("--cohesion-pa", command->target.cohesion_pa, "Cohesion in Pa, 0 to 4500")->required();
  app->add_option("--bulk-density-kg-m3", command->target.bulk_density_kg_m3,
                  "Bulk density in kg/m³, mean of the upper 15 cm")
      ->required();
  std::map<std::string, SoilStrength> words;
  for (const auto& word : kSoilStrengthWords) {
    words.emplace(word.name, word.value);
  }
  app->add_option("--strength", command->target.strength,
                  "Strength to match: residual, after large strain; or peak, of undisturbed soil [residual]")
      ->transform(wordOf(words));
  app->add_option("--radius-mm", command->radius_mm, "Radius of a particle in mm, 0.5 to 20")->capture_default_str();
  app->add_option(
      "--stiffness-n-m", command->stiffness_n_m,
      "Contact stiffness [so that contacts deform by 2.8 % of the radius at 0.3 of the largest pressure; 0.35 % with "
      "constant density]");
  app->add_option("--max-pressure-kpa", command->max_pressure_kpa,
                  "Largest pressure under tools, which sets the contact stiffness, 0.1 to 1000")
      ->capture_default_str();
  app->add_option("--density", command->density,
                  "Density profile: lunar, increasing with depth, or constant, as in a laboratory box [lunar]")
      ->transform(wordOf(std::map<std::string, DensityProfile>{{"lunar", DensityProfile::kLunar},
                                                               {"constant", DensityProfile::kConstant}}));
  app->add_option("--body", command->body, "Celestial body where the soil has that density")->capture_default_str();
  app->add_option("--out", command->out_file, "Soil file to write, for --soil (.toml)");
  command->overwrite.addTo(*app);
  app->add_option("--name", command->name, "Name of the soil in that file [the file's name]");
  app->add_option("--source", command->source, "Source of the target values, for that file");
  app->add_option("--specimens", command->specimens, "Number of specimens that verify the result, 2 or more")
      ->capture_default_str();
  app->add_option("--seed", command->seed, "Seed of the first specimen")
      ->check(wholeNumberIn(BedRanges::seed))
      ->capture_default_str();
  app->add_option("--threads", command->threads, fmt::format("{} [all]", kThreadsHelp))
      ->check(wholeNumberIn(BedRanges::threads));
  addJson(*app, command->json);
  app->footer(
      "Example:\n"
      "  haptolith soil calibrate --friction-angle-deg 42 --cohesion-pa 520 \\\n"
      "    --bulk-density-kg-m3 1500 --out soil.toml\n"
      "  haptolith run --soil soil.toml\nTo estimate the scatter between specimens, repeat with "
      "--seed 1 --json, --seed 2 --json, then:\n  haptolith lab collect calibrate-*.json");
  app->callback([command] {
    if (command->name.empty()) {
      command->name = std::filesystem::path(command->out_file).stem().string();
    }
    runCalibrateSoil(*command);
  });
}

}  // namespace haptolith
