// Catalogue entry of the blade test: options, table, numbers, findings.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/lab/catalogue/entries.h"
#include "haptolith/lab/report/findings.h"
#include "haptolith/lab/staged_progress.h"
#include "haptolith/lab/tests/blade.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

/// Clamps a strength to the range of the equations; scatter may exceed it.
MohrCoulomb inRange(const MohrCoulomb& strength) {
  return {.friction_angle_rad = std::clamp(strength.friction_angle_rad, radians(5), radians(59)),
          .cohesion_pa = std::max(0.0, strength.cohesion_pa)};
}

/// Returns a row of the table: the simulated value, and that of each equation if it has one.
std::string tableRow(std::string_view what, const std::string& measured,
                     const std::vector<std::optional<double>>& equations_n) {
  std::string row = fmt::format("  {:<29}  {:<17}", what, measured);
  for (const std::optional<double>& force_n : equations_n) {
    row += fmt::format("  {:<20}", force_n ? fmt::format("{:.3g}", *force_n) : "-");
  }
  row.erase(row.find_last_not_of(' ') + 1);
  return row + "\n";
}

std::string equationRows(const BladeEquations& equations, std::string_view strength, const std::string& draft,
                         const std::string& vertical) {
  const auto& [plane, upright, wedge] = equations;
  const auto of = [](const auto& force, auto value) { return force ? std::optional((*force).*value) : std::nullopt; };
  return tableRow(fmt::format("draft{} / N", strength), draft,
                  {plane.draft_n, of(upright, &BladeForce::draft_n), of(wedge, &WedgeForce::draft_n)}) +
         tableRow(fmt::format("downwards{} / N", strength), vertical,
                  {plane.vertical_n, of(upright, &BladeForce::vertical_n), of(wedge, &WedgeForce::vertical_n)});
}

std::string table(const BladeResult& result, const BladeOptions& options) {
  const auto measured = [](double value, double error) { return fmt::format("{:.3g} ± {:.2g}", value, error); };
  std::string text = fmt::format("  {:<29}  {:<17}  {:<20}  {:<20}  {}\n", "", "measured", "earthmoving equation",
                                 "... upright sides", "... crescents") +
                     equationRows(result.expected.undisturbed, "", measured(result.draft_n, result.draft_se_n),
                                  measured(result.vertical_n, result.vertical_se_n));
  if (result.expected.residual) {
    text += equationRows(*result.expected.residual, ", residual", "", "");
  }
  text += equationRows(result.expected_heaped.undisturbed, ", heaped", "", "");
  if (result.expected_heaped.residual) {
    text += equationRows(*result.expected_heaped.residual, ", residual, heaped", "", "");
  }
  text += tableRow("draft on its front / N", fmt::format("{:.3g}", result.front_draft_n), {});
  text += tableRow("downwards on it / N", fmt::format("{:.3g}", result.front_vertical_n), {});
  const std::string settled =
      fmt::format(" ({:.3g} were asked: its edge has its place before the soil settles)", options.depth_m / kMm);
  text += fmt::format("\n  {:.0f} mm wide, {:.1f} mm deep{}, bulk density {:.0f} kg/m³, {} particles\n",
                      result.width_m / kMm, result.depth_m / kMm, settled, result.bulk_density_kg_m3, result.particles);
  text += fmt::format("  the equations get {:.1f}° and {:.0f} Pa", degrees(options.friction_angle_rad),
                      options.cohesion_pa);
  if (options.residual) {
    text += fmt::format(", residual {:.1f}° and {:.0f} Pa", degrees(options.residual->friction_angle_rad),
                        options.residual->cohesion_pa);
  }
  text +=
      fmt::format("\n  where heaped, also what soil has come before the blade: {:.0f} Pa on the wedge", result.heap_pa);
  text +=
      result.expected.undisturbed.wedge ? fmt::format(", {:.0f} Pa on the crescents\n", result.heap_beside_pa) : "\n";
  if (const std::optional<WedgeForce>& wedge = result.expected.undisturbed.wedge) {
    text += fmt::format("  crescents break out {:.0f} mm ahead and {:.0f} mm to either side, at {:.0f}°\n",
                        wedge->rupture_distance_m / kMm, wedge->crescent_width_m / kMm, degrees(wedge->beta_rad));
  }
  return text;
}

/// Returns the values of the equations; null where an equation does not apply.
Json equationsJson(const BladeEquations& equations) {
  const auto number = [](const auto& force, auto value, double unit) {
    return force ? Json((*force).*value / unit) : Json(nullptr);
  };
  return {{"earthmoving_draft_n", equations.earthmoving.draft_n},
          {"earthmoving_vertical_n", equations.earthmoving.vertical_n},
          {"upright_wedge_draft_n", number(equations.upright_wedge, &BladeForce::draft_n, 1)},
          {"upright_wedge_vertical_n", number(equations.upright_wedge, &BladeForce::vertical_n, 1)},
          {"wedge_draft_n", number(equations.wedge, &WedgeForce::draft_n, 1)},
          {"wedge_vertical_n", number(equations.wedge, &WedgeForce::vertical_n, 1)},
          {"wedge_beta_deg", number(equations.wedge, &WedgeForce::beta_rad, radians(1))},
          {"wedge_rupture_distance_mm", number(equations.wedge, &WedgeForce::rupture_distance_m, kMm)},
          {"wedge_crescent_width_mm", number(equations.wedge, &WedgeForce::crescent_width_m, kMm)}};
}

/// Returns the values with the peak strength, and in `residual` those with the residual strength; null: unknown.
Json expectationJson(const BladeExpectation& expected, const std::optional<MohrCoulomb>& residual) {
  Json json = equationsJson(expected.undisturbed);
  json["residual"] = nullptr;
  if (expected.residual) {
    json["residual"] = equationsJson(*expected.residual);
    json["residual"]["friction_angle_deg"] = degrees(residual->friction_angle_rad);
    json["residual"]["cohesion_pa"] = residual->cohesion_pa;
  }
  return json;
}

LabOutput bladeOutput(const LabSoil& soil, const LabConditions& conditions, BladeOptions options, bool own_strength) {
  if (options.cohesion_pa != 0 && !own_strength) {
    throw InvalidParameter("soil_cohesion_pa", fmt::format("{:g}", options.cohesion_pa),
                           "given with friction_angle_deg; without it, both are simulated by shearing");
  }
  validate(conditions, options);  // fails now, not after minutes
  StagedProgress progress(conditions.progress);
  LabConditions staged = conditions;
  staged.progress = progress.inner();
  const double blade_from = own_strength ? 0 : 0.5;  // fraction of the test's time before the blade
  progress.enter(0, blade_from);
  if (!own_strength) {
    const BladeStrength strength = strengthBeforeBlade(staged, options.preparation);
    const MohrCoulomb undisturbed = inRange(strength.undisturbed);
    options.friction_angle_rad = undisturbed.friction_angle_rad;
    options.cohesion_pa = undisturbed.cohesion_pa;
    if (strength.residual) {
      options.residual = inRange(*strength.residual);
    }
  }
  progress.enter(blade_from, 1);
  const BladeResult result = bladeTest(staged, options);
  LabOutput output;
  output.text = table(result, options);
  output.json = {{"width_mm", result.width_m / kMm},
                 {"depth_mm", result.depth_m / kMm},
                 {"rake_deg", degrees(options.rake_rad)},
                 {"draft_n", result.draft_n},
                 {"draft_se_n", result.draft_se_n},
                 {"vertical_n", result.vertical_n},
                 {"vertical_se_n", result.vertical_se_n},
                 {"front_draft_n", result.front_draft_n},
                 {"front_vertical_n", result.front_vertical_n},
                 {"heap_pa", result.heap_pa},
                 {"heap_beside_pa", result.heap_beside_pa},
                 {"preparation", preparationWord(options.preparation)},
                 {"friction_angle_deg", degrees(options.friction_angle_rad)},
                 {"cohesion_pa", options.cohesion_pa},
                 {"bulk_density_kg_m3", result.bulk_density_kg_m3},
                 {"particles", result.particles}};
  output.json.update(expectationJson(result.expected, options.residual));
  output.json["heaped"] = expectationJson(result.expected_heaped, options.residual);
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
          .description = "Draw a blade at constant depth: draft, compared with earthmoving equations",
          .examples =
              "  haptolith lab blade --width-mm 50 --depth-mm 30 --rake-deg 90\n"
              "  haptolith lab blade --soil dry-sand --friction-angle-deg 35 --soil-cohesion-pa 0",
          .radius_mm = 3,
          .typical_s = 400,
          .options = {millimetresOption("width_mm", own->width_m, "Width of the blade"),
                      millimetresOption("depth_mm", own->depth_m, "Depth of the lower edge of the blade"),
                      degreesOption("rake_deg", own->rake_rad, "Angle between blade and path"),
                      preparationOption(own->preparation),
                      depthFromOption(own->depth_from),
                      {.key = "friction_angle_deg",
                       .help = "Friction angle for the equations",
                       .usual = "simulated by shearing the soil: peak and residual, or residual when loose",
                       .set = LabOption::Number([own, own_strength](double deg) {
                         own->friction_angle_rad = radians(deg);
                         *own_strength = true;
                       })},
                      numberOption("soil_cohesion_pa", own->cohesion_pa,
                                   "Cohesion for the equations, with a friction angle")},
          .run = [own, own_strength](const LabSoil& soil, const LabConditions& conditions) {
            return bladeOutput(soil, conditions, *own, *own_strength);
          }};
}

}  // namespace haptolith
