#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/calibration.h"
#include "haptolith/soil/layers.h"
#include "haptolith/soil/lunar_density.h"
#include "haptolith/soil/presets.h"
#include "haptolith/soil/strength.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "soil/density_figure.h"
#include "soil/named_soil_commands.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kMmPerM = 1e3;
constexpr double kCmPerM = 100;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPresetRadius = SoilParameters{}.radius_m;
constexpr double kPresetGravity = 1.625;  // Table II

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

// --- Conditions of the soil: common options of profile and calibrate ------------------------------------------------

struct Conditions {
  std::optional<std::string> body_given;
  std::optional<double> gravity_given;
  double radius_mm = kPresetRadius * kMmPerM;
  double stiffness_n_m = kInfinity;

  void addOptions(CLI::App& command, const std::string& radius_help) {
    CLI::Option* body = command.add_option("--body", body_given, fmt::format("{} [Moon]", kBodyHelp));
    command.add_option("--gravity-m-s2", gravity_given, "Gravity in m/s², instead of a body")->excludes(body);
    command.add_option("--radius-mm", radius_mm, radius_help + " [7]");
    command.add_option("--stiffness-n-m", stiffness_n_m,
                       "Stiffness limit k of the contacts in the density analysis [inf]");
  }

  std::string body() const { return gravity_given ? "" : std::string(findBody(body_given.value_or("Moon")).name); }
  double gravity() const { return gravity_given ? *gravity_given : findBody(body()).gravity_m_s2; }
  double radius() const { return radius_mm / kMmPerM; }
  std::string text() const {
    return fmt::format("{}gravity {:.4g} m/s², R = {:.4g} mm, k {}", gravity_given ? "" : body() + ", ", gravity(),
                       radius_mm, std::isinf(stiffness_n_m) ? "infinite" : fmt::format("= {:.4g} N/m", stiffness_n_m));
  }
};

Json textOrNull(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}
Json numberOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json parametersJson(const SoilParameters& soil, const std::string& preset, const Conditions& conditions) {
  return {{"preset", textOrNull(preset)},
          {"body", textOrNull(conditions.body())},
          {"gravity_m_s2", conditions.gravity()},
          {"radius_mm", conditions.radius_mm},
          {"gamma_nm", soil.gamma_nm},
          {"rho0_kg_m3", soil.rho0_kg_m3},
          {"rho_max_kg_m3", soil.rho_max_kg_m3},
          {"mu_hat", soil.mu_hat},
          {"stiffness_n_m", numberOrNull(soil.stiffness_n_m)}};
}

void printParameters(const SoilParameters& soil) {
  fmt::print("  gamma    {:>10.4g} N m\n", soil.gamma_nm);
  fmt::print("  rho0     {:>10.1f} kg/m³\n", soil.rho0_kg_m3);
  fmt::print("  rho_max  {:>10.1f} kg/m³\n", soil.rho_max_kg_m3);
  fmt::print("  mu_hat   {:>10.4f}\n", soil.mu_hat);
}

// --- Band means ------------------------------------------------------------------------------------------------------

struct Band {
  MeasuredBand measured;
  double density_kg_m3 = 0;
  double paper_kg_m3 = kInfinity;  ///< infinite: no value in the paper for this soil
};

std::vector<Band> bandsOf(const std::vector<Layer>& layers) {
  std::vector<Band> bands;
  for (const MeasuredBand& measured : measuredBands()) {
    bands.push_back({measured, bandMeanDensity(layers, measured.top_m, measured.bottom_m)});
  }
  return bands;
}

Json bandsJson(const std::vector<Band>& bands) {
  Json rows = Json::array();
  for (const Band& band : bands) {
    rows.push_back({{"top_m", band.measured.top_m},
                    {"bottom_m", band.measured.bottom_m},
                    {"density_kg_m3", band.density_kg_m3},
                    {"measured_kg_m3", band.measured.density_kg_m3},
                    {"measured_tolerance_kg_m3", band.measured.tolerance_kg_m3},
                    {"paper_kg_m3", numberOrNull(band.paper_kg_m3)}});
  }
  return rows;
}

void printBands(const std::vector<Band>& bands) {
  const bool has_paper = std::isfinite(bands.front().paper_kg_m3);
  fmt::print("Mean bulk density, kg/m³\n  depth        density   measured{}\n", has_paper ? "     paper" : "");
  for (const Band& band : bands) {
    const double difference = band.density_kg_m3 - band.measured.density_kg_m3;
    const bool agrees = std::abs(difference) <= band.measured.tolerance_kg_m3;
    fmt::print("  {:>2.0f} - {:.0f} cm   {:>7.0f}   {:>4.0f} ± {:.0f}", band.measured.top_m * kCmPerM,
               band.measured.bottom_m * kCmPerM, band.density_kg_m3, band.measured.density_kg_m3,
               band.measured.tolerance_kg_m3);
    fmt::print("{}{}\n", has_paper ? fmt::format("   {:>4.0f}", band.paper_kg_m3) : "",
               agrees ? "" : "   outside the measurement");
  }
}

// --- haptolith soil icra2021 profile ---------------------------------------------------------------------------------

struct ProfileOptions {
  std::optional<std::string> preset, soil;
  std::optional<double> gamma_nm, rho0_kg_m3, rho_max_kg_m3, mu_hat;
  Conditions conditions;
  std::string figure;
  Overwrite overwrite;
  bool json = false;
};

constexpr const char* kCustomSoil = "--gamma-nm, --rho0-kg-m3, --rho-max-kg-m3 and --mu-hat";

/// Throws for contact friction. The analysis holds for layers with the friction of the icra2021 model; particles with
/// contact friction are packed less densely, and there is no formula for it.
[[noreturn]] void refuseToAnalyse(const std::string& name, const std::string& name_or_file) {
  throw InvalidParameter(
      "soil", inQuotes(name),
      fmt::format(
          "P1 to P6, or a soil file with friction_model = 'icra2021'; for the density of this soil, use haptolith lab "
          "settle --soil {}; for its friction and cohesion, haptolith soil list",
          plainText(name_or_file)));
}

SoilParameters namedSoil(const std::string& name_or_file) {
  const NamedSoil found = findSoilOrPreset(name_or_file);
  if (found.soil.friction == FrictionModel::kContact) {
    refuseToAnalyse(found.name, name_or_file);
  }
  return found.soil;
}

SoilParameters soilOf(const ProfileOptions& options) {
  requireInRange("radius_mm", options.conditions.radius_mm, {0.01, 1000});  // range of the library, in the user's unit
  SoilParameters soil;
  if (options.preset) {
    soil = rescaled(findPreset(*options.preset).soil, options.conditions.radius());
  } else if (options.soil) {
    soil = rescaled(namedSoil(*options.soil), options.conditions.radius());
  } else if (options.gamma_nm && options.rho0_kg_m3 && options.rho_max_kg_m3 && options.mu_hat) {
    soil.gamma_nm = *options.gamma_nm;
    soil.rho0_kg_m3 = *options.rho0_kg_m3;
    soil.rho_max_kg_m3 = *options.rho_max_kg_m3;
    soil.mu_hat = *options.mu_hat;
    soil.radius_m = options.conditions.radius();
  } else {
    throw CLI::RequiredError(fmt::format("--preset, --soil, or all of {},", kCustomSoil));
  }
  soil.stiffness_n_m = options.conditions.stiffness_n_m;
  return soil;
}

/// Content of the output of `soil icra2021 profile`.
struct Profile {
  SoilParameters soil;
  std::string preset;
  std::vector<Layer> layers;
  std::vector<Band> bands;
  double cohesion_pa = kInfinity;  ///< infinite: (paper 18) does not apply, this soil cannot be compacted to rho_1
  double friction_coefficient = 0;
};

Profile makeProfile(const ProfileOptions& options) {
  Profile profile;
  profile.soil = soilOf(options);
  profile.layers = layersToDepth(profile.soil, options.conditions.gravity(), kLunarLawDepthM);
  profile.bands = bandsOf(profile.layers);
  profile.friction_coefficient = frictionCoefficient(profile.soil.mu_hat);
  try {
    profile.cohesion_pa = cohesion(profile.soil);
  } catch (const InvalidParameter&) {  // the soil is valid because layersToDepth() accepted it
  }
  if (options.preset) {
    const Preset& preset = findPreset(*options.preset);
    profile.preset = preset.name;
    const bool as_in_the_paper = options.conditions.gravity() == kPresetGravity &&
                                 profile.soil.radius_m == preset.soil.radius_m &&
                                 std::isinf(profile.soil.stiffness_n_m);
    for (std::size_t i = 0; as_in_the_paper && i < profile.bands.size(); ++i) {
      profile.bands[i].paper_kg_m3 = preset.table1_density_kg_m3[i];
    }
  }
  return profile;
}

void printProfileJson(const Profile& profile, const Conditions& conditions) {
  Json layers = Json::array();
  for (const Layer& layer : profile.layers) {
    layers.push_back({{"layer", layer.layer},
                      {"depth_m", layer.depth_m},
                      {"spacing_m", layer.spacing_m},
                      {"density_kg_m3", layer.density_kg_m3}});
  }
  const Json document{{"parameters", parametersJson(profile.soil, profile.preset, conditions)},
                      {"layers", layers},
                      {"bands", bandsJson(profile.bands)},
                      {"cohesion_pa", numberOrNull(profile.cohesion_pa)},
                      {"friction_coefficient", profile.friction_coefficient},
                      {"friction_angle_deg", degrees(frictionAngle(profile.friction_coefficient))}};
  printJson(document);
}

void printLayers(const std::vector<Layer>& layers) {
  constexpr std::size_t kMostRows = 25;
  const std::size_t step = (layers.size() + kMostRows - 1) / kMostRows;
  fmt::print("Layers{}\n  layer   depth/cm   spacing/mm   density/(kg/m³)\n",
             step == 1 ? "" : fmt::format(", one in {}; --json has all {}", step, layers.size()));
  for (std::size_t i = 0; i < layers.size(); i += step) {
    const Layer& layer = layers[i];
    fmt::print("  {:>5}   {:>8.2f}   {:>10.3f}   {:>15.1f}\n", layer.layer, layer.depth_m * kCmPerM,
               layer.spacing_m * kMmPerM, layer.density_kg_m3);
  }
}

void printProfileText(const Profile& profile, const Conditions& conditions) {
  fmt::print("{} ({})\n", profile.preset.empty() ? "Soil" : "Soil " + profile.preset, conditions.text());
  printParameters(profile.soil);
  fmt::print("\nFriction coefficient {:.3f} (angle {:.1f}°), cohesion {}\n\n", profile.friction_coefficient,
             degrees(frictionAngle(profile.friction_coefficient)),
             std::isfinite(profile.cohesion_pa)
                 ? fmt::format("{:.0f} Pa", profile.cohesion_pa)
                 : fmt::format("undefined: this soil cannot be compacted to {:.0f} kg/m³", kCompactedDensity));
  printBands(profile.bands);
  fmt::print("\n");
  printLayers(profile.layers);
}

/// Whether --soil is a preset, as in all commands.
bool isPreset(const std::string& name) {
  return std::ranges::any_of(presets(), [&](const Preset& preset) {
    return CLI::detail::to_lower(std::string(preset.name)) == CLI::detail::to_lower(name);
  });
}

void runProfile(ProfileOptions options) {
  if (options.soil && isPreset(*options.soil)) {
    options.preset = std::exchange(options.soil, std::nullopt);
  }
  const Profile profile = makeProfile(options);
  if (!options.figure.empty()) {
    drawDensityFigure(options.overwrite(options.figure), {profile.soil, options.conditions.gravity(), profile.preset});
  }
  if (options.json) {
    printProfileJson(profile, options.conditions);
  } else {
    printProfileText(profile, options.conditions);
  }
}

void addProfile(CLI::App& icra2021) {
  auto options = std::make_shared<ProfileOptions>();
  CLI::App* command =
      icra2021.add_subcommand("profile", "Print density over depth, cohesion and friction of a soil at rest");
  CLI::Option* preset = command->add_option("--preset", options->preset, "Soil of the ICRA 2021 paper, P1 to P6");
  const std::vector<CLI::Option*> custom{
      command->add_option("--gamma-nm", options->gamma_nm, "Parameter gamma of the contact law in N m"),
      command->add_option("--rho0-kg-m3", options->rho0_kg_m3, "Bulk density at the surface in kg/m³"),
      command->add_option("--rho-max-kg-m3", options->rho_max_kg_m3, "Upper limit of the bulk density in kg/m³"),
      command->add_option("--mu-hat", options->mu_hat, "Friction of the model: friction coefficient / sqrt(6)")};
  CLI::Option* soil_option =
      command->add_option("--soil", options->soil, "P1 to P6, or a soil file with friction_model = 'icra2021'")
          ->excludes(preset);
  for (CLI::Option* option : custom) {
    option->excludes(preset)->excludes(soil_option);
  }
  options->conditions.addOptions(*command, "Radius of a particle in mm; gamma of a preset is scaled with its cube");
  command->add_option("--figure", options->figure, "Draw density over depth to this file (.svg or .png)");
  options->overwrite.addTo(*command);
  addJson(*command, options->json);
  command->footer(
      "Examples:\n"
      "  haptolith soil icra2021 profile --preset P3\n"
      "  haptolith soil icra2021 profile --preset P3 --body Mars --figure p3-on-mars.svg\n"
      "  haptolith soil icra2021 profile --gamma-nm 4e-5 --rho0-kg-m3 1330 --rho-max-kg-m3 1824 \\\n"
      "    --mu-hat 0.342");
  command->callback([options] { runProfile(*options); });
}

// --- haptolith soil icra2021 calibrate -------------------------------------------------------------------------------

struct CalibrateOptions {
  double friction_coefficient = 0;
  double cohesion_pa = 0;
  Conditions conditions;
  bool json = false;
};

void printCalibrationJson(const Calibration& result, const std::vector<Band>& bands, const Conditions& conditions) {
  Json document = parametersJson(result.soil, "", conditions);
  document.erase("preset");
  document["friction_coefficient"] = frictionCoefficient(result.soil.mu_hat);
  document["cohesion_pa"] = result.cohesion_pa;
  document["density_rms_kg_m3"] = result.density_rms_kg_m3;
  document["bands"] = bandsJson(bands);
  printJson(document);
}

void printCalibrationText(const Calibration& result, const std::vector<Band>& bands, const Conditions& conditions) {
  fmt::print("Calibrated soil ({})\n", conditions.text());
  printParameters(result.soil);
  fmt::print("\nFriction coefficient {:.3f}, cohesion {:.0f} Pa, density {:.1f} kg/m³ (RMS) from the lunar law\n\n",
             frictionCoefficient(result.soil.mu_hat), result.cohesion_pa, result.density_rms_kg_m3);
  printBands(bands);
}

void runCalibrate(const CalibrateOptions& options) {
  const Conditions& conditions = options.conditions;
  // Ranges of the library are in m, those of the user in mm.
  requireInRange("radius_mm", conditions.radius_mm, {0.5, 20});
  const Calibration result = calibrate({.friction_coefficient = options.friction_coefficient,
                                        .cohesion_pa = options.cohesion_pa,
                                        .gravity_m_s2 = conditions.gravity(),
                                        .radius_m = conditions.radius(),
                                        .stiffness_n_m = conditions.stiffness_n_m});
  const std::vector<Band> bands = bandsOf(layersToDepth(result.soil, conditions.gravity(), kLunarLawDepthM));
  if (options.json) {
    printCalibrationJson(result, bands, conditions);
  } else {
    printCalibrationText(result, bands, conditions);
  }
}

void addCalibrate(CLI::App& icra2021) {
  CLI::App* command = icra2021.add_subcommand(
      "calibrate", "Calibrate the ICRA 2021 friction model to a friction coefficient and cohesion");
  auto options = std::make_shared<CalibrateOptions>();
  command->add_option("--friction-coefficient", options->friction_coefficient, "Tangent of the friction angle, 0 to 2")
      ->required();
  command->add_option("--cohesion-pa", options->cohesion_pa, "Cohesion in Pa")->required();
  options->conditions.addOptions(*command, "Radius of a particle in mm, 0.5 to 20");
  addJson(*command, options->json);
  command->footer(
      "Examples:\n"
      "  haptolith soil icra2021 calibrate --friction-coefficient 0.9 --cohesion-pa 970\n"
      "  haptolith soil icra2021 calibrate --friction-coefficient 0.7 --cohesion-pa 500 --body Mars\n"
      "For measured soil, use haptolith soil calibrate.");
  command->callback([options] { runCalibrate(*options); });
}

// --- haptolith soil icra2021 list ------------------------------------------------------------------------------------

void printPresetsJson() {
  Json rows = Json::array();
  for (const Preset& preset : presets()) {
    rows.push_back({{"name", preset.name},
                    {"friction_coefficient", preset.friction_coefficient},
                    {"mu_hat", preset.soil.mu_hat},
                    {"gamma_nm", preset.soil.gamma_nm},
                    {"rho0_kg_m3", preset.soil.rho0_kg_m3},
                    {"rho_max_kg_m3", preset.soil.rho_max_kg_m3},
                    {"radius_mm", preset.soil.radius_m * kMmPerM},
                    {"stiffness_n_m", preset.soil.stiffness_n_m},
                    {"gravity_m_s2", kPresetGravity},
                    {"cohesion_pa", cohesion(preset.soil)}});
  }
  printJson(Json{{"presets", rows}});
}

void printPresetsText() {
  fmt::print("Soils of the ICRA 2021 paper (Table II), for R = 7 mm and lunar gravity\n\n");
  fmt::print("        friction   angle   mu_hat    gamma    rho0   rho_max   cohesion\n");
  fmt::print("                       °               N m   kg/m³     kg/m³         Pa\n");
  for (const Preset& preset : presets()) {
    const SoilParameters& soil = preset.soil;
    fmt::print("  {:<4}  {:>8.3f}   {:>5.1f}   {:>6.3f}  {:>7.1e}   {:>5.0f}   {:>7.0f}   {:>8.0f}\n", preset.name,
               preset.friction_coefficient, degrees(frictionAngle(preset.friction_coefficient)), soil.mu_hat,
               soil.gamma_nm, soil.rho0_kg_m3, soil.rho_max_kg_m3, cohesion(soil));
  }
}

void addPresets(CLI::App& icra2021) {
  auto json = std::make_shared<bool>(false);
  CLI::App* command = icra2021.add_subcommand("list", "List the six soils P1 to P6 of the ICRA 2021 paper");
  addJson(*command, *json);
  command->footer("Example:\n  haptolith soil icra2021 list");
  command->callback([json] { *json ? printPresetsJson() : printPresetsText(); });
}

}  // namespace

void addSoilCommands(CLI::App& app) {
  constexpr const char* kMore = "Run a command with --help for its options.";
  CLI::App* soil = app.add_subcommand("soil", "List, show and calibrate soils");
  soil->require_subcommand(1);
  soil->footer(
      fmt::format("Examples:\n  haptolith soil list\n  haptolith soil icra2021 profile --preset P3\n{}", kMore));
  addNamedSoilCommands(*soil);
  CLI::App* icra2021 = soil->add_subcommand("icra2021", "Soils and friction of the ICRA 2021 paper");
  icra2021->require_subcommand(1);
  icra2021->footer(fmt::format("Example:\n  haptolith soil icra2021 profile --preset P3\n{}", kMore));
  addPresets(*icra2021);
  addProfile(*icra2021);
  addCalibrate(*icra2021);
}

}  // namespace haptolith
