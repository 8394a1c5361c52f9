// Catalogue entry of the angle-of-repose test: options, table, numbers, findings.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

#include "haptolith/lab/catalogue/entries.h"
#include "haptolith/lab/report/findings.h"
#include "haptolith/lab/tests/repose.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

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

}  // namespace

LabTest reposeEntry() {
  auto own = std::make_shared<ReposeOptions>();
  return {.name = "repose",
          .description = "Lift a tube of soil off a rough floor: angle of repose",
          .examples =
              "  haptolith lab repose --soil dry-sand --body Earth --figure heap.png\n"
              "  haptolith lab repose --soil dry-sand --body Ceres",
          .radius_mm = 3,  // larger ones are too soft for Earth's gravity: 25.6 instead of 27.1 degrees for dry-sand
          .without_cohesion = true,
          .typical_s = 60,
          .options = {numberOption("tube_radius", own->tube_radius, "Radius of the tube, in particle radii"),
                      numberOption("fill", own->fill, "Height of the soil in the tube, in particle radii"),
                      preparationOption(own->preparation)},
          .run = [own](const LabSoil& soil, const LabConditions& conditions) {
            return reposeOutput(soil, conditions, *own);
          }};
}

}  // namespace haptolith
