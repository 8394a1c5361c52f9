#include <CLI/App.hpp>
#include <fmt/format.h>

#include <memory>
#include <string>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/identify/soil_belief.h"
#include "haptolith/scene_file/soil_file.h"

#include "identify/belief_report.h"
#include "identify/identify_commands.h"
#include "identify/measured_options.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/saved.h"

namespace haptolith {

namespace {

constexpr const char* kIdentifySoilExamples = R"(Examples:
  haptolith identify soil measured.csv
  haptolith identify soil press.csv cut.csv               parts of the probe, in any order
  haptolith identify soil trace.csv --origin-mm 0,0,70 --soil-out found.toml
  haptolith run teleop-model --set soil.file=found.toml   run the estimated soil

Format of the table: docs/how-to/identify-a-soil.md; accuracy: docs/reports/identification.md)";

struct SoilOptions {
  MeasuredOptions measured;
  std::string soil_out;
  double radius_mm = 5, density_kg_m3 = 1500;
  Overwrite overwrite;
  bool json = false;
};

/// Returns soil for scenes with the properties of the belief.
SoilFile soilFileOf(const SoilOptions& options, const SoilBelief& belief, const StrengthMap& strengths) {
  SoilFile file;
  file.name = "identified";
  file.source = fmt::format("haptolith identify soil, from forces on a tool; cohesion {:.0f} to {:.0f} Pa (90 %)",
                            belief.cohesion_pa.low, belief.cohesion_pa.high);
  file.target.bulk_density_kg_m3 = options.density_kg_m3;
  file.target.friction_angle_deg = belief.friction_angle_deg.middle;
  file.target.friction_angle_range_deg = Range{belief.friction_angle_deg.low, belief.friction_angle_deg.high};
  file.target.cohesion_pa = belief.cohesion_pa.middle;
  file.target.cohesion_range_pa = Range{belief.cohesion_pa.low, belief.cohesion_pa.high};
  SoilParameters soil = lunarContacts();
  constexpr double kBulk_kg_m3 = 1500;  // density of lunarContacts() in the upper 15 cm
  soil.rho0_kg_m3 *= options.density_kg_m3 / kBulk_kg_m3;
  soil.rho_max_kg_m3 *= options.density_kg_m3 / kBulk_kg_m3;
  file.soil = strengths.with(rescaled(soil, options.radius_mm * 1e-3),
                             {belief.friction_angle_deg.middle, belief.cohesion_pa.middle});
  return file;
}

void identifySoil(const SoilOptions& options) {
  if (!options.soil_out.empty()) {
    requireFree(options.overwrite(options.soil_out));
  }
  const Measured measured = measuredBy(options.measured);
  const SoilPrior prior;
  const SoilBelief belief = measured.identifier.identify(measured.matched.forces, measured.gravity_m_s2);
  if (!options.soil_out.empty()) {
    AtomicFile file(options.overwrite(options.soil_out));
    file.write(soilFileText(soilFileOf(options, belief, measured.identifier.emulator().strengths())));
    file.commit();
  }
  if (options.json) {
    nlohmann::ordered_json json = measured.json(options.measured);
    json["soil"] = beliefJson(belief, prior, measured.gravity_m_s2);
    printJson(json);
    return;
  }
  printText("identify soil: " + measured.text(options.measured) + "\n" +
            beliefText(belief, prior, measured.gravity_m_s2));
  printNotice(savedText());
}

}  // namespace

void addIdentifySoil(CLI::App& identify) {
  auto options = std::make_shared<SoilOptions>();
  CLI::App* command = identify.add_subcommand("soil", "Estimate soil parameters from measured tool forces");
  command->footer(kIdentifySoilExamples);
  options->measured.addTo(*command, true);
  command->add_option("--density-kg-m3", options->density_kg_m3, "Bulk density, for --soil-out")
      ->option_text("RHO [1500]")
      ->check(numberIn({1000, 2500}));
  command->add_option("--soil-out", options->soil_out, "Write a soil file with the estimated strength")
      ->option_text("FILE.toml");
  command->add_option("--radius-mm", options->radius_mm, "Radius of a particle, for --soil-out")
      ->option_text("R [5]")
      ->check(numberIn({0.5, 20}));
  options->overwrite.addTo(*command);
  addJson(*command, options->json);
  command->callback([options] { identifySoil(*options); });
}

}  // namespace haptolith
