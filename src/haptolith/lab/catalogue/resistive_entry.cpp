// Catalogue entry of the comparison with resistive force theory: options, table, numbers.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <memory>

#include "haptolith/lab/catalogue/entries.h"
#include "haptolith/lab/tests/resistive_comparison.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

std::string pushTable(const ResistiveResult& result) {
  std::string text = "  pushed in     depth / mm   our bed / N   theory / N   ratio\n";
  for (const ResistivePush& push : result.pushes) {
    for (std::size_t i = 10; i < push.curve.size(); i += 10) {
      const ResistivePoint& point = push.curve[i];
      text += fmt::format("  {:<12} {:>11.1f}   {:>11.3g}   {:>10.3g}   {:>5.2f}\n", i == 10 ? push.name : "",
                          point.depth_m / kMm, point.bed_n, point.theory_n, point.bed_n / point.theory_n);
    }
  }
  return text;
}

std::string bladeTable(const ResistiveResult& result) {
  return fmt::format(
      "\n  blade, {:.1f} mm deep   our bed / N     theory / N   ratio   earthmoving equation / N\n"
      "  draft                 {:>7.3g} ± {:<5.2g} {:>10.3g}   {:>5.2f}   {:>10.3g}\n"
      "  upwards               {:>7.3g}         {:>10.3g}   {:>5.2f}\n",
      result.blade_depth_m / kMm, result.draft_n, result.draft_se_n, result.theory_draft_n,
      result.draft_n / result.theory_draft_n, result.earthmoving_draft_n, -result.vertical_n, -result.theory_vertical_n,
      result.vertical_n / result.theory_vertical_n);
}

std::string scalingTable(const ResistiveResult& result) {
  if (result.scalings.empty()) {
    return {};
  }
  std::string text =
      "\n  the plate's force grows with   factor   force x   our exponent   theory's   bed's density x\n";
  for (const ResistiveScaling& scaling : result.scalings) {
    text +=
        fmt::format("  {:<28} {:>8.2f}   {:>7.2f}   {:>12.2f}   {:>8.2f}   {:>15.2f}\n", scaling.name, scaling.factor,
                    scaling.force_factor, scaling.exponent, scaling.theory_exponent, scaling.density_factor);
  }
  return text;
}

std::string soilLine(const ResistiveResult& result) {
  const double mu = result.soil.internal_friction;
  std::string text = fmt::format(
      "\n  the theory gets {:.0f} kg/m³, {:.1f}° and {:.3g} m/s²: xi_n = {:.3g} kN/m³; no cohesion in either\n",
      result.soil.density_kg_m3, degrees(std::atan(mu)), result.soil.gravity_m_s2, result.xi_n_m3 / 1e3);
  if (mu < kResistiveFriction.lowest || mu > kResistiveFriction.highest) {
    text += fmt::format("  tan {:.1f}° = {:.2f} is outside {:g} to {:g}, where the theory's scale was fitted\n",
                        degrees(std::atan(mu)), mu, kResistiveFriction.lowest, kResistiveFriction.highest);
  }
  return text;
}

LabOutput resistiveOutput(const LabConditions& conditions, const ResistiveOptions& options) {
  const ResistiveResult result = resistiveComparison(conditions, options);
  LabOutput output;
  output.text = pushTable(result) + bladeTable(result) + scalingTable(result) + soilLine(result);
  Json pushes = Json::array();
  for (const ResistivePush& push : result.pushes) {
    Json curve = Json::array();
    for (const ResistivePoint& point : push.curve) {
      curve.push_back({{"depth_m", point.depth_m}, {"force_n", point.bed_n}, {"theory_n", point.theory_n}});
    }
    pushes.push_back({{"name", push.name},
                      {"mean_force_n", push.bed_n},
                      {"mean_theory_n", push.theory_n},
                      {"bulk_density_kg_m3", push.bulk_density_kg_m3},
                      {"ratio", push.bed_n / push.theory_n},
                      {"curve", curve}});
  }
  Json scalings = Json::array();
  for (const ResistiveScaling& scaling : result.scalings) {
    scalings.push_back({{"name", scaling.name},
                        {"factor", scaling.factor},
                        {"force_factor", scaling.force_factor},
                        {"density_factor", scaling.density_factor},
                        {"exponent", scaling.exponent},
                        {"theory_exponent", scaling.theory_exponent}});
  }
  output.json = {{"density_kg_m3", result.soil.density_kg_m3},
                 {"friction_angle_deg", degrees(std::atan(result.soil.internal_friction))},
                 {"xi_n_m3", result.xi_n_m3},
                 {"pushes", pushes},
                 {"blade_depth_mm", result.blade_depth_m / kMm},
                 {"draft_n", result.draft_n},
                 {"draft_se_n", result.draft_se_n},
                 {"theory_draft_n", result.theory_draft_n},
                 {"earthmoving_draft_n", result.earthmoving_draft_n},
                 {"vertical_n", result.vertical_n},
                 {"theory_vertical_n", result.theory_vertical_n},
                 {"scalings", scalings}};
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawResistive(path, result, title); };
  return output;
}

}  // namespace

LabTest rftEntry() {
  auto own = std::make_shared<ResistiveOptions>();
  return {.name = "rft",
          .description = "Compare plate, sphere, cone, wheel and blade with 3-D resistive force theory",
          .examples =
              "  haptolith lab rft --soil dry-sand --figure rft.svg\n"
              "  haptolith lab rft --soil dry-sand --body Earth --no-scaling",
          .radius_mm = 5,
          .in_report = false,
          .typical_s = 300,
          .options = {millimetresOption("diameter_mm", own->diameter_m, "Diameter of plate, sphere, cone and wheel"),
                      millimetresOption("max_sinkage_mm", own->max_sinkage_m, "Largest sinkage"),
                      millimetresOption("blade_width_mm", own->blade_width_m, "Width of the blade"),
                      millimetresOption("blade_depth_mm", own->blade_depth_m, "Depth of the lower edge of the blade"),
                      numberOption("size_factor", own->size_factor, "Size of the larger plate over the smaller"),
                      numberOption("box_diameters", own->bed_width_diameters,
                                   "Width of the square box, in diameters of the tool"),
                      {.key = "no_scaling",
                       .help = "Omit the scaling with gravity, density and size",
                       .usual = "",
                       .set = LabOption::Switch([own] { own->scaling = false; })},
                      preparationOption(own->preparation),
                      depthFromOption(own->depth_from),
                      {.key = "friction_angle_deg",
                       .help = "Friction angle for the theory",
                       .usual = "residual, simulated by shearing the soil",
                       .set = LabOption::Number([own](double deg) { own->friction_angle_rad = radians(deg); })}},
          .run = [own](const LabSoil&, const LabConditions& conditions) { return resistiveOutput(conditions, *own); }};
}

}  // namespace haptolith
