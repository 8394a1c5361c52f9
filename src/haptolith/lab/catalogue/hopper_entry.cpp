// Catalogue entry of the hopper test: options, table, numbers, findings.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

#include "haptolith/lab/catalogue/entries.h"
#include "haptolith/lab/report/findings.h"
#include "haptolith/lab/tests/hopper.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

LabOutput hopperOutput(const LabConditions& conditions, const HopperOptions& options) {
  const HopperResult result = hopperTest(conditions, options);
  LabOutput output;
  const double d = result.particle_diameter_m;
  Json points = Json::array();
  Json clogged = Json::array();
  output.text = "  opening / d   rate / (g/s)\n";
  for (const HopperPoint& point : result.points) {
    points.push_back({{"opening_m", point.opening_m},
                      {"opening_diameters", point.opening_m / d},
                      {"rate_kg_s", point.rate_kg_s},
                      {"clogged", point.clogged}});
    output.text += fmt::format("  {:>11.1f}   {:>12}\n", point.opening_m / d,
                               point.clogged ? "clogged" : fmt::format("{:.3g}", point.rate_kg_s * 1e3));
    if (point.clogged) {
      clogged.push_back(point.opening_m / d);
    }
  }
  const bool has_exponent = result.hasExponent();
  output.text += has_exponent
                     ? fmt::format("\n  rate grows with the opening to the power of {:.2f} ± {:.2f}\n",
                                   result.fit.exponent, result.fit.exponent_se)
                     : "\n  too few wide openings ran for a power of the opening; soil with cohesion arches over "
                       "all of them: try one without (dry-sand), or stronger gravity\n";
  output.json = {{"exponent", has_exponent ? Json(result.fit.exponent) : Json(nullptr)},
                 {"exponent_se", has_exponent ? Json(result.fit.exponent_se) : Json(nullptr)},
                 {"clogged", clogged},
                 {"points", points}};
  output.findings = findings(result);
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawHopper(path, result, title); };
  return output;
}

}  // namespace

LabTest hopperEntry() {
  auto own = std::make_shared<HopperOptions>();
  return {.name = "hopper",
          .description = "Discharge a hopper through openings: Beverloo's exponent, clogging",
          .examples =
              "  haptolith lab hopper --soil dry-sand --body Earth\n"
              "  haptolith lab hopper --opening 2,4,6,8,10",
          .without_cohesion = true,
          .typical_s = 60,
          .options = {listOption("opening", own->openings, 1, "Widths of the openings, in particle diameters"),
                      numberOption("fill", own->fill_openings, "Height of the soil, in widths of the opening")},
          .run = [own](const LabSoil&, const LabConditions& conditions) { return hopperOutput(conditions, *own); }};
}

}  // namespace haptolith
