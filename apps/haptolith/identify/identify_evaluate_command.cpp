#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <optional>
#include <string>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/identify/check/soil_check.h"
#include "haptolith/identify/training/training_file.h"

#include "identify/identify_commands.h"
#include "identify/training_options.h"
#include "shared/common_options.h"
#include "shared/output.h"
#include "shared/saved.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kIdentifyEvaluateExamples = R"(Examples:
  haptolith identify evaluate --out hidden.json            50 soils: one hour on two cores
  haptolith identify evaluate --out hidden.json --resume   continue, or print the result again

Results of the built-in training: docs/reports/identification.md)";

struct EvaluateOptions {
  SoilsOptions soils;
  std::string training_file, figure_file;
  bool json = false;
};

std::string rowText(const CheckedSoil& row) {
  const auto part = [](double truth, const SoilEstimate& told, int decimals) {
    return fmt::format("{:7.{}f} {:7.{}f} {:7.{}f} {:7.{}f} {}", truth, decimals, told.low, decimals, told.middle,
                       decimals, told.high, decimals, holds(told, truth) ? ' ' : '*');
  };
  const SoilBelief& belief = row.belief;
  return fmt::format("{:4} {} {} {}  {}{}\n", row.number,
                     part(row.truth.friction_angle_deg, belief.friction_angle_deg, 1),
                     part(row.truth.cohesion_pa, belief.cohesion_pa, 0),
                     part(row.tool_friction_angle_deg, belief.tool_friction_angle_deg, 1),
                     belief.misfit > kStrange ? "out of distribution" : "", row.has_stone ? " stone" : "");
}

void evaluate(const EvaluateOptions& options) {
  const std::optional<Training> read =
      options.training_file.empty() ? std::nullopt : std::optional(readTraining(options.training_file));
  const Training& training = read ? *read : probeTraining();
  if (!options.figure_file.empty()) {
    requireFree(options.soils.overwrite(options.figure_file));  // before an hour of work
  }
  const Training hidden = dugSoils(options.soils, hiddenNumber);
  const SoilCheck checked(training, hidden);
  if (!options.figure_file.empty()) {
    drawCheck(options.soils.overwrite(options.figure_file), checked.soils());
  }
  if (options.json) {
    Json json{{"soils", checked.soils().size()}};
    for (const bool with_stones : {true, false}) {
      Json& part = json[with_stones ? "all" : "without_stone"];
      for (const CheckedNumber& number : checked.numbers(with_stones)) {
        part[number.name] = {{"median_error", number.median_error}, {"held_by_90", number.held_share}};
      }
    }
    json["strange"] = checked.strange();
    printJson(json);
    return;
  }
  std::string text =
      "     friction angle, deg              cohesion, Pa                     soil-tool friction, deg\n"
      "soil    true    from  median      to     true    from  median      to     true    from  median      to\n";
  for (const CheckedSoil& row : checked.soils()) {
    text += rowText(row);
  }
  text += "\n* outside the 90 % interval\n";
  for (const bool with_stones : {true, false}) {
    text +=
        with_stones ? "\nall soils                   median error  covered by 90 % intervals\n" : "\nwithout a stone\n";
    for (const CheckedNumber& number : checked.numbers(with_stones)) {
      text += fmt::format("  {:28} {:>9}  {:21.0f} %\n", number.name,
                          fmt::format("{:.{}f}{}", number.median_error, number.decimals, number.unit),
                          100 * number.held_share);
    }
  }
  printText(text);
  printNotice(savedText());
}

}  // namespace

void addIdentifyEvaluate(CLI::App& identify) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command = identify.add_subcommand(
      "evaluate", "Evaluate the estimates with soils outside the training, against a shear test");
  command->footer(kIdentifyEvaluateExamples);
  command->add_option("--out", options->soils.out_file, "File for the forces of these soils on the tool")
      ->option_text("FILE.json")
      ->required();
  command->add_option("--training", options->training_file, "Training file")->option_text("FILE.json [the probe's]");
  options->soils.addTo(*command, 50);
  command->add_option("--figure", options->figure_file, "Draw estimates over true values (.svg or .png)")
      ->option_text("FILE");
  addJson(*command, options->json);
  command->callback([options] { evaluate(*options); });
}

}  // namespace haptolith
