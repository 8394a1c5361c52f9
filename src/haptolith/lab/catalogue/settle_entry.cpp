// Catalogue entry of the settle test: options, table, numbers, findings.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

#include "haptolith/lab/apparatus/settle.h"
#include "haptolith/lab/catalogue/entries.h"
#include "haptolith/lab/report/findings.h"
#include "haptolith/soil/lunar_density.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

LabOutput settleOutput(const LabSoil& soil, const LabConditions& conditions, const SettleOptions& options) {
  const SettleResult result = settleTest(conditions, options);
  LabOutput output;
  Json bands = Json::array();
  Json slices = Json::array();
  const bool lunar = isLunar(conditions.gravity_m_s2, soil.target);
  output.findings = findings(result, conditions.gravity_m_s2, soil.target);
  output.text = "  depth / cm   density / (kg/m³)   should be\n";
  for (std::size_t i = 0; i < result.bands.size(); ++i) {
    const SettledBand& band = result.bands[i];
    bands.push_back({{"top_m", band.top_m}, {"bottom_m", band.bottom_m}, {"density_kg_m3", band.density_kg_m3}});
    for (const MeasuredBand& measured : measuredBands()) {
      if (lunar && measured.top_m == band.top_m && measured.bottom_m == band.bottom_m) {
        bands.back()["measured_kg_m3"] = measured.density_kg_m3;
        bands.back()["measured_tolerance_kg_m3"] = measured.tolerance_kg_m3;
      }
    }
    output.text += fmt::format("  {:>4.0f} - {:<3.0f}   {:>14.0f}        {}\n", band.top_m * 100, band.bottom_m * 100,
                               band.density_kg_m3, output.findings[i].target);
  }
  for (const SettledSlice& slice : result.slices) {
    slices.push_back({{"depth_m", slice.depth_m}, {"density_kg_m3", slice.density_kg_m3}});
  }
  output.json = {{"depth_m", result.depth_m}, {"settled_after_s", result.time_s}, {"bands", bands}, {"slices", slices}};
  output.trace = result.trace;
  output.draw = [conditions, result, lunar](const OutputFile& path, const std::string& title) {
    drawSettle(path, conditions, result, lunar, title);
  };
  return output;
}

}  // namespace

LabTest settleEntry() {
  auto own = std::make_shared<SettleOptions>();
  return {.name = "settle",
          .description = "Let soil settle under its weight: density over depth",
          .examples =
              "  haptolith lab settle\n"
              "  haptolith lab settle --soil dry-sand --body Earth --figure density.svg",
          .typical_s = 20,
          .options = {numberOption("depth_m", own->depth_m, "Minimum depth of the column")},
          .run = [own](const LabSoil& soil, const LabConditions& conditions) {
            return settleOutput(soil, conditions, *own);
          }};
}

}  // namespace haptolith
