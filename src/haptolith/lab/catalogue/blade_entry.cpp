// The blade test as others offer it: options, table, numbers, findings.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>

#include "haptolith/lab/blade.h"
#include "haptolith/lab/catalogue/entries.h"
#include "haptolith/lab/findings.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

LabOutput bladeOutput(const LabSoil& soil, const LabConditions& conditions, BladeOptions options, bool own_strength) {
  if (!own_strength) {
    const MohrCoulomb strength = strengthBeforeBlade(conditions, options.preparation);
    options.friction_angle_rad = std::clamp(strength.friction_angle_rad, radians(5), radians(59));
    options.cohesion_pa = std::max(0.0, strength.cohesion_pa);
  }
  const BladeResult result = bladeTest(conditions, options);
  LabOutput output;
  output.text = fmt::format(
      "                 measured           earthmoving equation\n"
      "  draft / N      {:7.3g} ± {:.2g}    {:7.3g}\n"
      "  downwards / N  {:7.3g} ± {:.2g}    {:7.3g}\n\n"
      "  {:.0f} mm wide, {:.1f} mm deep, bulk density {:.0f} kg/m³, {} particles\n"
      "  the equation gets {:.1f}° and {:.0f} Pa\n",
      result.draft_n, result.draft_se_n, result.earthmoving_draft_n, result.vertical_n, result.vertical_se_n,
      result.earthmoving_vertical_n, result.width_m / kMm, result.depth_m / kMm, result.bulk_density_kg_m3,
      result.particles, degrees(options.friction_angle_rad), options.cohesion_pa);
  output.json = {{"width_mm", result.width_m / kMm},
                 {"depth_mm", result.depth_m / kMm},
                 {"rake_deg", degrees(options.rake_rad)},
                 {"draft_n", result.draft_n},
                 {"draft_se_n", result.draft_se_n},
                 {"vertical_n", result.vertical_n},
                 {"vertical_se_n", result.vertical_se_n},
                 {"earthmoving_draft_n", result.earthmoving_draft_n},
                 {"earthmoving_vertical_n", result.earthmoving_vertical_n},
                 {"preparation", options.preparation == Preparation::kLoose ? "loose" : "dense"},
                 {"friction_angle_deg", degrees(options.friction_angle_rad)},
                 {"cohesion_pa", options.cohesion_pa},
                 {"bulk_density_kg_m3", result.bulk_density_kg_m3},
                 {"particles", result.particles}};
  output.findings = findings(result, soil.target);
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawBlade(path, result, title); };
  return output;
}

}  // namespace

LabTest bladeEntry() {
  auto own = std::make_shared<BladeOptions>();
  auto own_strength = std::make_shared<bool>(false);
  return {.name = "blade",
          .description = "A blade drawn at constant depth: draft, against the earthmoving equation",
          .examples =
              "  haptolith lab blade --width-mm 50 --depth-mm 30 --rake-deg 90\n"
              "  haptolith lab blade --soil dry-sand --friction-angle-deg 35 --soil-cohesion-pa 0",
          .radius_mm = 3,
          .options = {millimetresOption("width_mm", own->width_m, "width of the blade"),
                      millimetresOption("depth_mm", own->depth_m, "depth of its lower edge"),
                      degreesOption("rake_deg", own->rake_rad, "angle between blade and path"),
                      preparationOption(own->preparation),
                      {.key = "friction_angle_deg",
                       .help = "for the equation",
                       .usual = "measured by shearing the soil: its peak, or its residual when loose",
                       .set = LabOption::Number([own, own_strength](double deg) {
                         own->friction_angle_rad = radians(deg);
                         *own_strength = true;
                       })},
                      numberOption("soil_cohesion_pa", own->cohesion_pa, "for the equation, beside a friction angle")},
          .run = [own, own_strength](const LabSoil& soil, const LabConditions& conditions) {
            return bladeOutput(soil, conditions, *own, *own_strength);
          }};
}

}  // namespace haptolith
