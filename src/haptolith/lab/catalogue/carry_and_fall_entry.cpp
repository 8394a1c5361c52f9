// Catalogue entries of the payload and free-fall tests: options, table, numbers, findings.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <memory>

#include "haptolith/lab/catalogue/entries.h"
#include "haptolith/lab/report/findings.h"
#include "haptolith/lab/tests/carry.h"
#include "haptolith/lab/tests/fall.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

/// Rounds to a number of digits for display; never returns -0.
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

}  // namespace

LabTest carryEntry() {
  auto own = std::make_shared<CarryOptions>();
  return {.name = "carry",
          .description = "Hold, move and shake a loaded shovel: rendered weight and drag",
          .examples = "  haptolith lab carry\n  haptolith lab carry --friction-model icra2021",
          .typical_s = 1,
          .options = {countOption("particles", own->particles, CarryRanges::particles,
                                  "Number of particles dropped on the shovel"),
                      numberOption("speed_m_s", own->speed_m_s, "Sideways speed of the shovel")},
          .run = [own](const LabSoil&, const LabConditions& conditions) { return carryOutput(conditions, *own); }};
}

LabTest fallEntry() {
  auto own = std::make_shared<FallOptions>();
  return {.name = "fall",
          .description = "Drop a clump of particles: acceleration over g",
          .examples = "  haptolith lab fall\n  haptolith lab fall --friction-model icra2021",
          .typical_s = 5,
          .options = {numberOption("fall_m", own->fall_m, "Height of the fall")},
          .run = [own](const LabSoil&, const LabConditions& conditions) { return fallOutput(conditions, *own); }};
}

}  // namespace haptolith
