#include "identify/belief_report.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace haptolith {

namespace {

/// Quantity of a belief, formatted for a terminal.
struct Line {
  const char* name;
  const char* key;
  SoilEstimate estimate;
  Range before;
  const char* unit;
  int decimals;
  const char* note;
};

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

std::array<Line, 4> linesOf(const SoilBelief& belief, const SoilPrior& prior, double gravity_m_s2) {
  const auto pascals = [&](double cohesion_m) { return cohesion_m * 1500 * gravity_m_s2; };
  const auto angle = [](double friction) { return degrees(std::atan(friction)); };
  return {Line{"friction angle", "friction_angle_deg", belief.friction_angle_deg, prior.friction_angle_deg, "°", 1,
               "residual: after large strain"},
          Line{"", "peak_angle_deg", belief.peak_angle_deg, prior.friction_angle_deg, "°", 1,
               "peak: undisturbed dense soil"},
          Line{"cohesion",
               "cohesion_pa",
               belief.cohesion_pa,
               {pascals(prior.cohesion_m.lowest), pascals(prior.cohesion_m.highest)},
               " Pa",
               0,
               "residual"},
          Line{"soil-tool friction",
               "tool_friction_angle_deg",
               belief.tool_friction_angle_deg,
               {angle(prior.tool_friction.lowest), angle(prior.tool_friction.highest)},
               "°",
               1,
               ""}};
}

}  // namespace

std::string beliefText(const SoilBelief& belief, const SoilPrior& prior, double gravity_m_s2) {
  std::string text = fmt::format("  {:20} {:>9}  {:>16}\n", "", "", "90 % interval");
  for (const Line& line : linesOf(belief, prior, gravity_m_s2)) {
    if (isIdentified(line.estimate, line.before)) {
      const auto number = [&](double value) { return fmt::format("{:.{}f}", value, line.decimals); };
      text += fmt::format("  {:20} {:>9}  {:>16}  {}\n", line.name, number(line.estimate.middle) + line.unit,
                          number(line.estimate.low) + " to " + number(line.estimate.high), line.note);
    } else if (*line.name != '\0') {
      text += fmt::format("  {:20} {:>9}  not identified by these forces\n", line.name, "");
    }
  }
  text +=
      fmt::format("  {:20} {:>9}  not identified: weigh a scoop of soil (haptolith identify density)\n", "density", "");
  text += fmt::format("  {:20} {:>9}  not identified: its effect is smaller than the differences between soils\n",
                      "adhesion to the tool", "");
  if (belief.misfit > kStrange) {
    text += fmt::format(
        "  These forces are out of distribution: {:.1f} times the usual distance from the training. The soil is\n  of "
        "another kind, or it contains an object such as a stone. Do not trust the numbers above.\n",
        belief.misfit);
  }
  return text;
}

nlohmann::ordered_json beliefJson(const SoilBelief& belief, const SoilPrior& prior, double gravity_m_s2) {
  nlohmann::ordered_json json;
  for (const Line& line : linesOf(belief, prior, gravity_m_s2)) {
    json[line.key] = {{"median", line.estimate.middle},
                      {"interval_90", {line.estimate.low, line.estimate.high}},
                      {"identified", isIdentified(line.estimate, line.before)}};
  }
  json["misfit"] = belief.misfit;
  json["strange"] = belief.misfit > kStrange;
  return json;
}

}  // namespace haptolith
