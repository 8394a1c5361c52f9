// Catalogue entries of the plate and cone tests: options, table, numbers, findings.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>

#include "haptolith/lab/catalogue/entries.h"
#include "haptolith/lab/report/findings.h"
#include "haptolith/lab/staged_progress.h"
#include "haptolith/lab/tests/cone.h"
#include "haptolith/lab/tests/plate.h"
#include "haptolith/lab/tests/soil_strength.h"
#include "haptolith/lab/theory/bearing_capacity.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

/// Given strength of the soil, for bearing capacity.
struct Strength {
  std::optional<double> friction_angle_rad;
  double cohesion_pa = 0;
  bool measured = false;  ///< whether to shear the soil instead
};

void requireOneStrength(const Strength& strength) {
  if (strength.measured && strength.friction_angle_rad) {
    throw InvalidParameter("friction_angle_deg", fmt::format("{:g}", degrees(*strength.friction_angle_rad)),
                           "left out with measure_strength, which measures it");
  }
  if (strength.cohesion_pa != 0 && !strength.friction_angle_rad) {
    throw InvalidParameter("soil_cohesion_pa", fmt::format("{:g}", strength.cohesion_pa),
                           "given with friction_angle_deg");
  }
}

double pressureAt(const PlateResult& result, double sinkage_m) {
  return forceAt(result.curve, std::min(sinkage_m, result.curve.back().depth_m)) / result.area_m2;
}

/// Compares the plate with a footing at the same depth, at a sinkage of a tenth of its diameter.
void compareWithFooting(const PlateResult& result, const Footing& footing, LabOutput& output) {
  const double pressure_pa = pressureAt(result, footing.depth_m);
  const double terzaghi_pa = terzaghiBearing(footing).pressure_pa;
  const double local_pa = terzaghiLocalBearing(footing).pressure_pa;
  const double meyerhof_pa = meyerhofBearing(footing).pressure_pa;
  const double vesic_pa = vesicBearing(footing).pressure_pa;
  output.text += fmt::format(
      "\n  pressure at {:.1f} mm {:.3g} kPa; bearing capacity of a footing there, with {:.1f}° and {:.0f} Pa: Terzaghi "
      "{:.3g},\n"
      "  Meyerhof {:.3g}, Vesic {:.3g} kPa, and Terzaghi {:.3g} for soil so loose that it heaves nowhere\n",
      footing.depth_m / kMm, pressure_pa / 1e3, degrees(footing.friction_angle_rad), footing.cohesion_pa,
      terzaghi_pa / 1e3, meyerhof_pa / 1e3, vesic_pa / 1e3, local_pa / 1e3);
  output.json["bearing"] = {{"sinkage_mm", footing.depth_m / kMm},
                            {"pressure_pa", pressure_pa},
                            {"friction_angle_deg", degrees(footing.friction_angle_rad)},
                            {"cohesion_pa", footing.cohesion_pa},
                            {"terzaghi_pa", terzaghi_pa},
                            {"meyerhof_pa", meyerhof_pa},
                            {"vesic_pa", vesic_pa},
                            {"terzaghi_local_pa", local_pa}};
}

/// Compares the plate with a footing that punches into compressible soil, at the sinkage where such soil fails.
void compareWithPunching(const PlateResult& result, Footing footing, const SoilRigidity& rigidity, LabOutput& output) {
  constexpr double kFails = 0.2;  // 0.15 to 0.25 D: Das, Principles of Foundation Engineering
  footing.depth_m = std::min(kFails * footing.diameter_m, result.curve.back().depth_m);
  const double pressure_pa = pressureAt(result, footing.depth_m);
  const CompressibleBearing punching = vesicCompressibleBearing(
      footing, {.shear_modulus_pa = rigidity.shear_modulus_pa, .volume_strain = rigidity.volume_strain});
  output.text += fmt::format(
      "  pressure at {:.1f} mm {:.3g} kPa; Vesic for soil that is compressed {:.3g} kPa: rigidity index {:.3g} of the "
      "{:.3g} of\n  general failure\n",
      footing.depth_m / kMm, pressure_pa / 1e3, punching.pressure_pa / 1e3, punching.rigidity_index,
      punching.critical_rigidity_index);
  output.json["punching"] = {{"sinkage_mm", footing.depth_m / kMm},
                             {"pressure_pa", pressure_pa},
                             {"vesic_pa", punching.pressure_pa},
                             {"shear_modulus_pa", rigidity.shear_modulus_pa},
                             {"volume_strain", rigidity.volume_strain},
                             {"rigidity_index", punching.rigidity_index},
                             {"critical_rigidity_index", punching.critical_rigidity_index}};
}

/// Returns the strength of undisturbed soil, clamped to the range of the footing equations.
Strength measuredStrength(const LabConditions& conditions, Preparation preparation) {
  const MohrCoulomb line = undisturbedStrength(conditions, preparation, {1000, 2000, 4000});
  return {.friction_angle_rad = std::clamp(line.friction_angle_rad, 0.0, radians(50)),
          .cohesion_pa = std::max(0.0, line.cohesion_pa),
          .measured = true};
}

/// Returns the slope of the force in the last third of the sinkage over that in the second; 1: the force grows
/// linearly.
double lateSlopeRatio(const PlateResult& result) {
  const PushReading& deepest = result.curve.back();
  const double a_third_n = forceAt(result.curve, deepest.depth_m / 3);
  const double two_thirds_n = forceAt(result.curve, deepest.depth_m * 2 / 3);
  return (deepest.force_n - two_thirds_n) / (two_thirds_n - a_third_n);
}

LabOutput plateOutput(const LabConditions& conditions, const PlateOptions& options, Strength strength) {
  constexpr double kSunk = 0.1;   // sinkage over the diameter
  validate(conditions, options);  // fails now, not after minutes
  StagedProgress progress(conditions.progress);
  LabConditions staged = conditions;
  staged.progress = progress.inner();
  if (strength.measured) {
    progress.enter(0, 0.3);
    strength = measuredStrength(staged, options.preparation);
    progress.enter(0.3, 0.6);
  }
  Footing footing{.diameter_m = options.diameter_m,
                  .depth_m = std::min(kSunk * options.diameter_m, options.max_sinkage_m),
                  .density_kg_m3 = conditions.soil.rho0_kg_m3,
                  .gravity_m_s2 = conditions.gravity_m_s2,
                  .friction_angle_rad = strength.friction_angle_rad.value_or(0),
                  .cohesion_pa = strength.cohesion_pa};
  if (strength.friction_angle_rad) {
    (void)vesicBearing(footing);  // fails now, not after minutes
  }
  std::optional<SoilRigidity> rigidity;
  if (strength.measured && options.preparation == Preparation::kDense) {  // denseRigidity() knows no other soil
    const double under_plate_m = footing.depth_m + footing.diameter_m / 2;
    rigidity = denseRigidity(staged, footing.density_kg_m3 * footing.gravity_m_s2 * under_plate_m);
  }
  progress.enter(strength.measured ? 0.6 : 0, 1);
  const PlateResult result = plateTest(staged, options);
  LabOutput output;
  Json curve = Json::array();
  output.text = "  sinkage / mm   force / N\n";
  for (std::size_t i = 0; i < result.curve.size(); ++i) {
    const PushReading& reading = result.curve[i];
    curve.push_back({{"sinkage_m", reading.depth_m}, {"force_n", reading.force_n}});
    if (i % 6 == 0) {
      output.text += fmt::format("  {:>12.1f}   {:>9.3g}\n", reading.depth_m / kMm, reading.force_n);
    }
  }
  output.text += fmt::format("\n  p = k z^n: k = {:.4g} Pa/m^n, n = {:.2f}; bulk density {:.0f} kg/m³\n",
                             result.fit.modulus, result.fit.exponent, result.bulk_density_kg_m3);
  output.json = {{"plate_diameter_mm", options.diameter_m / kMm},
                 {"curve", curve},
                 {"max_sinkage_mm", options.max_sinkage_m / kMm},
                 {"pressure_at_max_sinkage_pa", result.curve.back().force_n / result.area_m2},
                 {"late_slope_ratio", lateSlopeRatio(result)},
                 {"exponent", result.fit.exponent},
                 {"modulus", result.fit.modulus},
                 {"bulk_density_kg_m3", result.bulk_density_kg_m3},
                 {"particles", result.particles}};
  if (strength.friction_angle_rad) {
    footing.density_kg_m3 = result.bulk_density_kg_m3;
    compareWithFooting(result, footing, output);
    if (rigidity) {
      compareWithPunching(result, footing, *rigidity, output);
    }
  }
  output.findings = findings(result, options.diameter_m);
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawPlate(path, result, title); };
  return output;
}

LabOutput coneOutput(const LabConditions& conditions, const ConeOptions& options) {
  const ConeResult result = coneTest(conditions, options);
  LabOutput output;
  Json curve = Json::array();
  output.text = "  depth / mm   resistance / kPa\n";
  for (std::size_t i = 0; i < result.curve.size(); ++i) {
    const ConePoint& point = result.curve[i];
    curve.push_back({{"depth_m", point.depth_m}, {"resistance_pa", point.resistance_pa}});
    if (i % 5 == 0) {
      output.text += fmt::format("  {:>10.1f}   {:>16.3g}\n", point.depth_m / kMm, point.resistance_pa / 1e3);
    }
  }
  output.text += fmt::format("\n  cone index {:.3g} kPa, gradient {:.3g} kPa/m; bulk density {:.0f} kg/m³\n",
                             result.cone_index_pa / 1e3, result.gradient_pa_m / 1e3, result.bulk_density_kg_m3);
  output.json = {{"curve", curve},
                 {"cone_index_pa", result.cone_index_pa},
                 {"gradient_pa_m", result.gradient_pa_m},
                 {"bulk_density_kg_m3", result.bulk_density_kg_m3},
                 {"particles", result.particles}};
  output.findings = findings(result);
  output.trace = result.trace;
  output.draw = [result](const OutputFile& path, const std::string& title) { drawCone(path, result, title); };
  return output;
}

}  // namespace

LabTest plateEntry() {
  auto own = std::make_shared<PlateOptions>();
  auto strength = std::make_shared<Strength>();
  return {.name = "plate",
          .description = "Push a flat plate in: pressure over sinkage",
          .examples =
              "  haptolith lab plate --soil dry-sand --body Earth --plate-diameter-mm 60 --max-sinkage-mm 20\n"
              "  haptolith lab plate --soil dry-sand --friction-angle-deg 32",
          .radius_mm = 3.5,
          .typical_s = 120,
          .options = {millimetresOption("plate_diameter_mm", own->diameter_m, "Diameter of the plate"),
                      millimetresOption("max_sinkage_mm", own->max_sinkage_m, "Largest sinkage"),
                      preparationOption(own->preparation),
                      depthFromOption(own->depth_from),
                      numberOption("box_diameters", own->bed_width_diameters,
                                   "Width of the square box, in plate diameters"),
                      millimetresOption("loose_top_mm", own->loose_top_m, "Thickness of the loose layer poured on top"),
                      {.key = "friction_angle_deg",
                       .help = "Friction angle of the footing whose bearing capacity is compared",
                       .usual = "not compared",
                       .set = LabOption::Number([strength](double deg) {
                         strength->friction_angle_rad = radians(requireInRange("friction_angle_deg", deg, {0, 50}));
                       })},
                      numberOption("soil_cohesion_pa", strength->cohesion_pa,
                                   "Cohesion for the comparison, with a friction angle"),
                      {.key = "measure_strength",
                       .help = "Compare with a footing in soil of the strength that is simulated at 1 to 4 kPa",
                       .usual = "",
                       .set = LabOption::Switch([strength] { strength->measured = true; })}},
          .run = [own, strength](const LabSoil&, const LabConditions& conditions) {
            requireOneStrength(*strength);
            return plateOutput(conditions, *own, *strength);
          }};
}

LabTest coneEntry() {
  auto own = std::make_shared<ConeOptions>();
  return {.name = "cone",
          .description = "Push a cone penetrometer in: resistance over depth",
          .examples = "  haptolith lab cone --figure cone.svg",
          .radius_mm = 3,
          .typical_s = 120,
          .options = {millimetresOption("cone_diameter_mm", own->base_diameter_m, "Diameter of the cone's base"),
                      millimetresOption("max_depth_mm", own->max_depth_m, "Largest depth of the base"),
                      preparationOption(own->preparation), depthFromOption(own->depth_from),
                      numberOption("box_diameters", own->bed_width_diameters,
                                   "Width of the square box, in diameters of the cone")},
          .run = [own](const LabSoil&, const LabConditions& conditions) { return coneOutput(conditions, *own); }};
}

}  // namespace haptolith
