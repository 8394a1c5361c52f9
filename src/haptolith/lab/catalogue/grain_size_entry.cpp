// Catalogue entry of the test of force roughness against particle size: options, table, numbers, findings.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

#include "haptolith/lab/catalogue/entries.h"
#include "haptolith/lab/tests/grain_size.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

LabOutput grainSizeOutput(const LabConditions& conditions, const GrainSizeOptions& options) {
  const std::vector<GrainSizeResult> results = grainSizeTest(conditions, options);
  LabOutput output;
  Json sizes = Json::array();
  output.text = "  grains                   number   draft / N   variation / %   without the filter / %\n";
  output.trace.columns = {"finest_radius_m", "travel_m", "draft_n", "filtered_n"};
  for (const GrainSizeResult& result : results) {
    output.text +=
        fmt::format("  {:<22} {:>8}   {:>5.2f} ± {:<4.2f}   {:>7.1f}         {:>7.1f}\n", result.name, result.particles,
                    result.draft_n, result.draft_sd_n, 100 * result.variation, 100 * result.unfiltered_variation);
    Json spectrum = Json::array();
    for (const GrainSpectrumPoint& point : result.spectrum) {
      spectrum.push_back({{"frequency_hz", point.frequency_hz}, {"power_n2_per_hz", point.power_n2_per_hz}});
    }
    sizes.push_back({{"name", result.name},
                     {"finest_radius_m", result.radius_m},
                     {"particles", result.particles},
                     {"draft_n", result.draft_n},
                     {"draft_sd_n", result.draft_sd_n},
                     {"variation", result.variation},
                     {"unfiltered_variation", result.unfiltered_variation},
                     {"spectrum", spectrum}});
    for (const std::vector<double>& row : result.trace) {
      output.trace.rows.push_back({result.radius_m, row[0], row[1], row[2]});
    }
  }
  output.text += fmt::format(
      "\n  ±: from specimen to specimen. variation: standard deviation of the draft about a straight line, over its "
      "mean,\n  after a low-pass filter of {:g} Hz. The discrimination threshold for force is about {:.0f} %.\n",
      options.filter_cutoff_hz, 100 * kForceJnd);
  output.json = {{"sizes", sizes}};
  output.draw = [results](const OutputFile& path, const std::string& title) { drawGrainSize(path, results, title); };
  return output;
}

}  // namespace

LabTest grainSizeEntry() {
  auto own = std::make_shared<GrainSizeOptions>();
  return {
      .name = "grain-size",
      .description = "Draw a blade through particles of several sizes: roughness of the rendered force",
      .examples =
          "  haptolith lab grain-size --figure grain.png\n"
          "  haptolith lab grain-size --radii-mm 7,3.5 --no-graded --specimens 1",
      .in_report = false,
      .typical_s = 300,
      .options = {listOption("radii_mm", own->radii_m, kMm, "Particle radii of the beds of one size"),
                  {.key = "no_graded",
                   .help = "Omit the bed with particles of several sizes",
                   .usual = "",
                   .set = LabOption::Switch([own] { own->graded = false; })},
                  millimetresOption("fine_radius_mm", own->fine_radius_m, "Radius of the finest particles of that bed"),
                  millimetresOption("width_mm", own->width_m, "Width of the blade"),
                  millimetresOption("depth_mm", own->depth_m, "Depth of the lower edge of the blade"),
                  numberOption("speed_m_s", own->speed_m_s, "Speed of the blade"),
                  countOption("specimens", own->specimens, GrainSizeRanges::specimens, "Number of beds of each size")},
      .run = [own](const LabSoil& /*soil*/, const LabConditions& conditions) {
        return grainSizeOutput(conditions, *own);
      }};
}

}  // namespace haptolith
