// Catalogue entry of the vertical-cut test: options, table, numbers, findings.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

#include "haptolith/lab/catalogue/entries.h"
#include "haptolith/lab/report/findings.h"
#include "haptolith/lab/tests/vertical_cut.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

LabOutput verticalCutOutput(const LabSoil& soil, const LabConditions& conditions, const VerticalCutOptions& options) {
  const VerticalCutResult result = verticalCutTest(conditions, options);
  LabOutput output;
  output.text =
      fmt::format("  a vertical cut of {:.0f} mm {}\n  {:.0f} % of its height is left, its toe went {:.0f} mm ahead\n",
                  options.height_m / kMm, result.stands ? "stands" : "does not stand", 100 * result.height_kept,
                  result.toe_ahead_m / kMm);
  output.json = {{"height_m", options.height_m},
                 {"stands", result.stands},
                 {"height_kept", result.height_kept},
                 {"crest_back_m", result.crest_back_m},
                 {"toe_ahead_m", result.toe_ahead_m}};
  output.findings = findings(result, options.height_m, soil.target);
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawVerticalCut(path, result, title); };
  return output;
}

}  // namespace

LabTest verticalCutEntry() {
  auto own = std::make_shared<VerticalCutOptions>();
  return {.name = "vertical-cut",
          .description = "Remove the support of a vertical cut: does it stand?",
          .examples =
              "  haptolith lab vertical-cut\n"
              "  haptolith lab vertical-cut --soil dry-sand --figure cut.png",
          .typical_s = 60,
          .options = {millimetresOption("height_mm", own->height_m, "Height of the cut")},
          .run = [own](const LabSoil& soil, const LabConditions& conditions) {
            return verticalCutOutput(soil, conditions, *own);
          }};
}

}  // namespace haptolith
