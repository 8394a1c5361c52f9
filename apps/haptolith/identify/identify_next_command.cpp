#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/identify/check/parts_check.h"
#include "haptolith/identify/next_measurement.h"
#include "haptolith/identify/training/training_file.h"
#include "haptolith/soil/bodies.h"

#include "identify/identify_commands.h"
#include "identify/measured_options.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/saved.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kIdentifyNextExamples = R"(Examples:
  haptolith identify next --out first.csv                          choose the first part
  haptolith identify next measured.csv --out second.csv            choose the part after that
  haptolith identify next first.csv second.csv --target-width 10,400,14

Method and results: docs/reports/identification.md)";

struct NextOptions {
  MeasuredOptions measured;
  std::string out_file;
  std::vector<double> target_width;
  Overwrite overwrite;
  bool json = false, evaluate = false;
};

/// Returns the target widths as on the Moon. Cohesion scales with gravity: the same effect on Earth takes about six
/// times as much.
SoilWidths targetWidths(const NextOptions& options, double gravity_m_s2) {
  if (options.target_width.empty()) {
    return {12, 400 * gravity_m_s2 / findBody("Moon").gravity_m_s2, 15};
  }
  return {options.target_width[0], options.target_width[1], options.target_width[2]};
}

std::string widthsText(const SoilWidths& widths) {
  return fmt::format("{:>14.1f}°  {:>8.0f} Pa  {:>17.1f}°\n", widths.friction_angle_deg, widths.cohesion_pa,
                     widths.tool_friction_angle_deg);
}

Json widthsJson(const SoilWidths& widths) {
  return {{"friction_angle_deg", widths.friction_angle_deg},
          {"cohesion_pa", widths.cohesion_pa},
          {"tool_friction_angle_deg", widths.tool_friction_angle_deg}};
}

std::string adviceText(const std::vector<PartGain>& gains, const std::optional<PartGain>& next,
                       const std::vector<MovementPart>& parts, const SoilWidths& now, const SoilWidths& target) {
  if (isNarrow(now, target)) {
    return "All intervals are within their targets: no other part is needed.\n";
  }
  if (gains.empty()) {
    return "All parts are measured: this movement cannot narrow the remaining intervals.\n";
  }
  if (!next) {
    return fmt::format("No remaining part is expected to narrow a wide interval by {:.0f} %.\n", 100 * kHelps);
  }
  return fmt::format("Next: {}, the most informative part, {:.2f} bits per second.\n", parts[next->part].name,
                     next->bits_s);
}

void tellNext(const NextOptions& options) {
  if (!options.out_file.empty()) {
    requireFree(options.overwrite(options.out_file));
  }
  const Measured measured = measuredBy(options.measured);
  const SoilIdentifier& identifier = measured.identifier;
  const SoilWidths target = targetWidths(options, measured.gravity_m_s2);
  const SoilWidths now =
      widthsOf(beliefOf(measured.matched.forces, identifier.emulator(), identifier.temper(), measured.gravity_m_s2));
  const std::vector<PartGain> gains = expectedGains(measured.parts, identifier.emulator(), identifier.temper(),
                                                    measured.matched.forces, measured.gravity_m_s2);
  const std::optional<PartGain> next = nextPart(gains, now, target);
  if (next && !options.out_file.empty()) {
    writePoses(options.overwrite(options.out_file), measured.parts[next->part].movement, options.measured.originM());
  }
  if (options.json) {
    Json json = measured.json(options.measured);
    json["widths"] = widthsJson(now);
    json["target_widths"] = widthsJson(target);
    json["gains"] = Json::array();
    for (const PartGain& gain : gains) {
      json["gains"].push_back({{"name", measured.parts[gain.part].name},
                               {"duration_s", measured.parts[gain.part].movement.duration()},
                               {"bits", gain.bits},
                               {"widths", widthsJson(gain.widths)}});
    }
    json["next"] = next ? Json(measured.parts[next->part].name) : Json();
    printJson(json);
    return;
  }
  std::string text = "identify next: " + measured.text(options.measured) +
                     fmt::format("\n  {:38} {:>15}  {:>11}  {:>18}\n", "width of the 90 % interval", "friction angle",
                                 "cohesion", "soil-tool friction") +
                     fmt::format("  {:38} ", "now") + widthsText(now) + fmt::format("  {:38} ", "target") +
                     widthsText(target);
  for (const PartGain& gain : gains) {
    const MovementPart& part = measured.parts[gain.part];
    text +=
        fmt::format("  expected after {:19} {:3.1f} s ", part.name, part.movement.duration()) + widthsText(gain.widths);
  }
  printText(text + "\n" + adviceText(gains, next, measured.parts, now, target));
  printNotice(savedText());
}

// --- how well -------------------------------------------------------------------------------------------------------

constexpr std::array kOrders{std::pair{PartOrder::kByGain, "by gain"}, std::pair{PartOrder::kAsLearned, "as learned"},
                             std::pair{PartOrder::kAtRandom, "at random"}};

/// Target widths, from wide to narrow.
constexpr std::array kTargets{SoilWidths{16, 600, 20}, SoilWidths{14, 500, 16}, SoilWidths{12, 400, 14}};

void evaluateOrders(const NextOptions& options) {
  const std::optional<Training> read = options.measured.training_file.empty()
                                           ? std::nullopt
                                           : std::optional(readTraining(options.measured.training_file));
  const PartsCheck check(read ? *read : probeTraining());
  Json json;
  std::string text;
  for (const auto& [order, name] : kOrders) {
    const std::vector<PartsCourse> courses = check.courses(order);
    text += fmt::format("{}: {} soils\n", name, courses.size());
    text += "  parts  held by 90 %   median width                          over expected     within a quarter of it\n";
    for (const PartsRow& row : partsRows(courses)) {
      text += fmt::format("  {:5} {:11.1f} %   {:4.1f}° {:5.0f} Pa {:5.1f}°  {:15.2f} {:5.2f} {:5.2f} {:18.0f} %\n",
                          row.parts, 100 * row.held_share, row.median.friction_angle_deg, row.median.cohesion_pa,
                          row.median.tool_friction_angle_deg, row.over_expected.friction_angle_deg,
                          row.over_expected.cohesion_pa, row.over_expected.tool_friction_angle_deg,
                          100 * row.within_quarter);
      json[name]["after"].push_back({{"parts", row.parts},
                                     {"held_by_90", row.held_share},
                                     {"median_widths", widthsJson(row.median)},
                                     {"over_expected", widthsJson(row.over_expected)},
                                     {"within_a_quarter", row.within_quarter}});
    }
    for (const SoilWidths& target : kTargets) {
      const TimeUntil until = timeUntil(courses, target, check.duration());
      text += fmt::format("  until {:2.0f}°, {:3.0f} Pa, {:2.0f}°: {:5.1f} s in the mean, {} soils\n",
                          target.friction_angle_deg, target.cohesion_pa, target.tool_friction_angle_deg, until.mean_s,
                          until.soils);
      json[name]["until"].push_back({{"widths", widthsJson(target)}, {"mean_s", until.mean_s}, {"soils", until.soils}});
    }
  }
  if (options.json) {
    printJson(json);
  } else {
    printText(text);
  }
}

}  // namespace

void addIdentifyNext(CLI::App& identify) {
  auto options = std::make_shared<NextOptions>();
  CLI::App* command = identify.add_subcommand("next", "Choose the next part of a probe by its expected information");
  command->footer(kIdentifyNextExamples);
  options->measured.addTo(*command, false);
  command->add_option("--out", options->out_file, "Write the trajectory of the tool, one pose per millisecond")
      ->option_text("FILE.csv");
  command
      ->add_option("--target-width", options->target_width,
                   "Target widths of the 90 % intervals of friction angle (degrees), cohesion (Pa) and soil-tool "
                   "friction (degrees)")
      ->option_text("DEG,PA,DEG [12,400,15 on the Moon]")
      ->delimiter(',')
      ->expected(3)
      ->check(numberIn({0, 1e6}));
  command->add_flag(
      "--evaluate", options->evaluate,
      "Report instead how quickly each training soil is identified (leave-one-out), by order of the parts");
  options->overwrite.addTo(*command);
  addJson(*command, options->json);
  command->callback([options] { options->evaluate ? evaluateOrders(*options) : tellNext(*options); });
}

}  // namespace haptolith
