// Catalogue entries of the payload and free-fall tests: options, table, numbers, findings.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <memory>

#include "haptolith/lab/catalogue/entries.h"
#include "haptolith/lab/report/findings.h"
#include "haptolith/lab/tests/free_fall.h"
#include "haptolith/lab/tests/payload.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

/// Rounds to a number of digits for display; never returns -0.
double rounded(double value, int digits) {
  const double scale = std::pow(10, digits);
  return std::round(value * scale) / scale + 0.0;
}

LabOutput payloadOutput(const LabConditions& conditions, const PayloadOptions& options) {
  const PayloadResult result = payloadTest(conditions, options);
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
  output.draw = [result](const OutputFile& path, const std::string& title) { drawPayload(path, result, title); };
  return output;
}

LabOutput freeFallOutput(const LabConditions& conditions, const FreeFallOptions& options) {
  const FreeFallResult result = freeFallTest(conditions, options);
  LabOutput output;
  output.text =
      fmt::format("  acceleration / g   {:.5f}   ({} particles)\n", result.acceleration_ratio, result.particles);
  output.json = {{"acceleration_ratio", result.acceleration_ratio}, {"particles", result.particles}};
  output.findings = findings(result);
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawFreeFall(path, result, title); };
  return output;
}

}  // namespace

LabTest payloadEntry() {
  auto own = std::make_shared<PayloadOptions>();
  return {.name = "payload",
          .description = "Hold, move and shake a loaded shovel: rendered weight and drag",
          .examples = "  haptolith lab payload\n  haptolith lab payload --friction-model icra2021",
          .typical_s = 1,
          .options = {countOption("particles", own->particles, PayloadRanges::particles,
                                  "Number of particles dropped on the shovel"),
                      numberOption("speed_m_s", own->speed_m_s, "Sideways speed of the shovel")},
          .run = [own](const LabSoil&, const LabConditions& conditions) { return payloadOutput(conditions, *own); }};
}

LabTest freeFallEntry() {
  auto own = std::make_shared<FreeFallOptions>();
  return {.name = "free-fall",
          .description = "Drop a clump of particles: acceleration over g",
          .examples = "  haptolith lab free-fall\n  haptolith lab free-fall --friction-model icra2021",
          .typical_s = 5,
          .options = {numberOption("fall_m", own->fall_m, "Height of the fall")},
          .run = [own](const LabSoil&, const LabConditions& conditions) { return freeFallOutput(conditions, *own); }};
}

}  // namespace haptolith
