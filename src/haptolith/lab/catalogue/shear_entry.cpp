// Catalogue entry of the shear test: options, table, numbers, findings.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

#include "haptolith/lab/catalogue/entries.h"
#include "haptolith/lab/report/findings.h"
#include "haptolith/lab/tests/shear.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

LabOutput shearOutput(const LabSoil& soil, const LabConditions& conditions, const ShearOptions& options) {
  const ShearResult result = shearTest(conditions, options);
  LabOutput output;
  output.trace.columns = {"specimen", "displacement_m", "shear_pa", "normal_pa", "height_m"};
  Json points = Json::array();
  output.text = "  normal / Pa   peak / Pa   residual / Pa   dilation / %\n";
  for (const ShearPointResult& point : result.points) {
    for (const std::vector<double>& row : point.trace.rows) {
      output.trace.rows.push_back({static_cast<double>(points.size())});
      output.trace.rows.back().insert(output.trace.rows.back().end(), row.begin(), row.end());
    }
    points.push_back({{"normal_pa", point.normal_pa},
                      {"peak_pa", point.peak_pa},
                      {"residual_pa", point.residual_pa},
                      {"modulus_pa", point.modulus_pa},
                      {"compression", point.compression},
                      {"dilation", point.dilation}});
    output.text += fmt::format("  {:>11.0f}   {:>9.0f}   {:>13.0f}   {:>12.1f}\n", point.normal_pa, point.peak_pa,
                               point.residual_pa, 100 * point.dilation);
  }
  const auto line = [](std::string_view what, const MohrCoulomb& fit) {
    const bool is_scatter = fit.cohesion_pa < 0 && -fit.cohesion_pa <= 2 * fit.cohesion_se_pa;
    return fmt::format("  {:<9} friction angle {:4.1f} ± {:.1f}°, cohesion {:5.0f} ± {:.0f} Pa{}\n", what,
                       degrees(fit.friction_angle_rad), degrees(fit.friction_angle_se_rad),
                       is_scatter ? 0 : fit.cohesion_pa, fit.cohesion_se_pa,
                       is_scatter ? fmt::format(" (within error: the line meets {:.0f})", fit.cohesion_pa) : "");
  };
  output.text += "\n" + line("peak", result.peak) + line("residual", result.residual) +
                 fmt::format("  bulk density {:.0f} kg/m³ before shearing\n", result.bulk_density_kg_m3);
  output.json = {{"points", points},
                 {"peak_friction_angle_deg", degrees(result.peak.friction_angle_rad)},
                 {"peak_cohesion_pa", result.peak.cohesion_pa},
                 {"residual_friction_angle_deg", degrees(result.residual.friction_angle_rad)},
                 {"residual_friction_angle_se_deg", degrees(result.residual.friction_angle_se_rad)},
                 {"cohesion_pa", result.residual.cohesion_pa},
                 {"cohesion_se_pa", result.residual.cohesion_se_pa},
                 {"bulk_density_kg_m3", result.bulk_density_kg_m3}};
  output.findings = findings(result, soil.target);
  output.draw = [result](const OutputFile& path, const std::string& title) { drawShear(path, result, title); };
  return output;
}

}  // namespace

LabTest shearEntry() {
  auto own = std::make_shared<ShearOptions>();
  return {.name = "shear",
          .description = "Shear soil between rough plates: friction angle and cohesion",
          .examples =
              "  haptolith lab shear\n"
              "  haptolith lab shear --soil dry-sand --figure shear.svg\n"
              "  haptolith lab shear --friction-model icra2021 --json\n"
              "  haptolith lab shear --sizes 2",
          .typical_s = 150,
          .options = {listOption("normal_pa", own->normal_stresses_pa, 1, "Normal stresses, three or more"),
                      numberOption("strain", own->strain, "Travel of the plate, in heights of the specimen"),
                      countOption("sizes", own->grain_classes, {1, GrainClasses::kMost},
                                  "Number of particle sizes, equal volumes of each: R, R/2 and so on")},
          .run = [own](const LabSoil& soil, const LabConditions& conditions) {
            return shearOutput(soil, conditions, *own);
          }};
}

}  // namespace haptolith
