#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/identify/weighed_scoop.h"
#include "haptolith/soil/bodies.h"

#include "identify/identify_commands.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"

namespace haptolith {

namespace {

constexpr const char* kIdentifyDensityExamples = R"(Examples:
  haptolith identify density weighed.csv --empty-s 0,2 --full-s 8,10 --volume-cm3 44,3
  haptolith identify density weighed.csv --empty-s 0,2 --full-s 8,10 --empty-again-s 14,16 \
    --volume-cm3 44,3

Accuracy: docs/reports/identification.md)";

constexpr double kCm3 = 1e-6;  // in m^3

struct DensityOptions {
  std::string measured_file, body = "Moon";
  std::vector<double> empty_s, full_s, empty_again_s, volume_cm3;
  double gravity_m_s2 = 0, drift_n_s = 0;
  bool json = false;
};

Range between(const char* key, const std::vector<double>& times_s) {
  requireInRange(fmt::format("{}: second time", key), times_s[1], {.lowest = times_s[0], .ends = Ends::kOpenBelow});
  return {times_s[0], times_s[1]};
}

void tellDensity(const DensityOptions& options) {
  ScoopWeighing weighing{
      between("--empty-s", options.empty_s), between("--full-s", options.full_s), {}, options.drift_n_s};
  if (!options.empty_again_s.empty()) {
    weighing.empty_again_s = between("--empty-again-s", options.empty_again_s);
  }
  const double gravity_m_s2 = options.gravity_m_s2 > 0 ? options.gravity_m_s2 : findBody(options.body).gravity_m_s2;
  const ScoopMass scoop = weighScoop(readMeasured(options.measured_file), weighing, gravity_m_s2);
  requireMeasurable(scoop);
  const SoilEstimate mass_kg = massOf(scoop);
  std::optional<Uncertain> volume_m3;
  if (!options.volume_cm3.empty()) {
    requireInRange("--volume-cm3", options.volume_cm3[0], kScoopVolume_m3.in(kCm3));
    volume_m3 =
        Uncertain{kCm3 * options.volume_cm3[0], options.volume_cm3.size() > 1 ? kCm3 * options.volume_cm3[1] : 0};
  }
  std::optional<SoilEstimate> density_kg_m3;
  if (volume_m3) {
    density_kg_m3 = densityOf(scoop, *volume_m3);
  }
  if (options.json) {
    const auto json = [](const SoilEstimate& e) {
      return nlohmann::ordered_json{{"median", e.middle}, {"interval_90", {e.low, e.high}}};
    };
    nlohmann::ordered_json told{{"measured", options.measured_file}, {"gravity_m_s2", gravity_m_s2}};
    told["mass_kg"] = json(mass_kg);
    if (density_kg_m3) {
      told["volume_m3"] = {{"value", volume_m3->value}, {"error", volume_m3->error}};
      told["density_kg_m3"] = json(*density_kg_m3);
    }
    printJson(told);
    return;
  }
  std::string text = fmt::format("  {:10} {:>14}  {:>20}\n", "", "", "90 % interval");
  text += fmt::format("  {:10} {:>14}  {:>20}\n", "mass", fmt::format("{:.2f} g", 1e3 * mass_kg.middle),
                      fmt::format("{:.2f} to {:.2f}", 1e3 * mass_kg.low, 1e3 * mass_kg.high));
  if (density_kg_m3) {
    const double half_m3 = 1.645 * volume_m3->error;
    text += fmt::format(
        "  {:10} {:>14}  {:>20}\n", "volume", fmt::format("{:.1f} cm³", 1e6 * volume_m3->value),
        fmt::format("{:.1f} to {:.1f}", 1e6 * (volume_m3->value - half_m3), 1e6 * (volume_m3->value + half_m3)));
    text += fmt::format("  {:10} {:>14}  {:>20}\n", "density", fmt::format("{:.0f} kg/m³", density_kg_m3->middle),
                        fmt::format("{:.0f} to {:.0f}", density_kg_m3->low, density_kg_m3->high));
  } else {
    text += "  density    not estimated (needs --volume-cm3)\n";
  }
  printText(text);
}

}  // namespace

void addIdentifyDensity(CLI::App& identify) {
  auto options = std::make_shared<DensityOptions>();
  CLI::App* command =
      identify.add_subcommand("density", "Estimate bulk density from the weight and volume of scooped soil");
  command->footer(kIdentifyDensityExamples);
  command
      ->add_option(
          "measured", options->measured_file,
          "Table of scoop pose and force, z up: t_s, x_m, y_m, z_m, qw, qx, qy, qz, soil_fx_n, soil_fy_n, soil_fz_n")
      ->option_text("FILE.csv")
      ->required();
  const auto times = [&](const char* name, std::vector<double>& times_s, const char* help) {
    return command->add_option(name, times_s, help)
        ->option_text("FROM,TO")
        ->delimiter(',')
        ->expected(2)
        ->check(numberIn({-1e6, 1e6}));
  };
  times("--empty-s", options->empty_s, "Time span in which the empty scoop is held still in the air")->required();
  times("--full-s", options->full_s, "Time span in which the filled scoop is held still in the air")->required();
  times("--empty-again-s", options->empty_again_s, "Time span in which the emptied scoop is held still again");
  command->add_option("--drift-n-s", options->drift_n_s, "Standard deviation of the drift of the sensor per second")
      ->option_text("N/S [0]")
      ->check(numberIn({0, 1}));
  command
      ->add_option("--volume-cm3", options->volume_cm3,
                   "Volume of the soil in place, and the standard deviation of its error")
      ->option_text("V[,S]")
      ->delimiter(',')
      ->expected(1, 2)
      ->check(numberIn({0, 1e6}));
  command->add_option("--body", options->body, kBodyHelp)->capture_default_str();
  command->add_option("--gravity-m-s2", options->gravity_m_s2, "Gravity, instead of a body")
      ->option_text("G")
      ->check(numberIn({1e-3, 100}))
      ->excludes("--body");
  addJson(*command, options->json);
  command->callback([options] { tellDensity(*options); });
}

}  // namespace haptolith
