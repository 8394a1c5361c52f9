#include <CLI/App.hpp>
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>

#include "haptolith/core/atomic_file.h"
#include "haptolith/core/error.h"
#include "haptolith/identify/measured_movement.h"
#include "haptolith/identify/soil_belief.h"
#include "haptolith/identify/training_file.h"
#include "haptolith/scenario/soil_file.h"
#include "haptolith/soil/bodies.h"

#include "identify/belief_report.h"
#include "identify/identify_commands.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/overwrite.h"
#include "shared/saved.h"

namespace haptolith {

namespace {

constexpr const char* kExamples = R"(Examples:
  haptolith identify soil measured.csv
  haptolith identify soil trace.csv --origin-mm 0,0,70 --soil-out found.toml && haptolith run dig --set soil.file=found.toml

docs/identify.md tells what the table has to hold, and what the numbers are worth.)";

struct SoilOptions {
  std::string measured_file, training_file, soil_out;
  std::vector<double> origin_mm{0, 0, 0};
  std::string body = "Moon";
  double radius_mm = 5, density_kg_m3 = 1500;
  Overwrite overwrite;
  bool json = false;
};

/// Soil that behaves as it was believed to, for scenes.
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
  constexpr double kBulk_kg_m3 = 1500;  // of lunarContacts() in the upper 15 cm
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
  const std::optional<Training> read =
      options.training_file.empty() ? std::nullopt : std::optional(readTraining(options.training_file));
  const Training& training = read ? *read : probeTraining();
  const Vec3 origin_m = 1e-3 * Vec3(options.origin_mm[0], options.origin_mm[1], options.origin_mm[2]);
  const MatchedForces matched = matchForces(training.movement, readMeasured(options.measured_file), origin_m);
  if (matched.windows == 0) {
    throw Failure(
        options.measured_file +
        ": the tool is nowhere within 3 mm and 3 degrees of the movement that was learned; is --origin-mm right?");
  }
  const double gravity_m_s2 = findBody(options.body).gravity_m_s2;
  const SoilPrior prior;
  const SoilIdentifier identifier(training);
  const SoilBelief belief = identifier.identify(matched.forces, gravity_m_s2);
  if (!options.soil_out.empty()) {
    AtomicFile file(options.overwrite(options.soil_out));
    file.write(soilFileText(soilFileOf(options, belief, identifier.emulator().strengths())));
    file.commit();
  }
  if (options.json) {
    nlohmann::ordered_json json{{"measured", options.measured_file},
                                {"begin_s", matched.begin_s},
                                {"windows", matched.windows},
                                {"windows_of_movement", matched.forces.size()},
                                {"gravity_m_s2", gravity_m_s2}};
    json["soil"] = beliefJson(belief, prior, gravity_m_s2);
    printJson(json);
    return;
  }
  printText(
      fmt::format("identify soil: the movement begins at {:.2f} s; {} of {} windows are in place, {} numbers tell\n\n",
                  matched.begin_s, matched.windows, matched.forces.size(), belief.numbers) +
      beliefText(belief, prior, gravity_m_s2));
  printNotice(savedText());
}

}  // namespace

void addIdentifySoil(CLI::App& identify) {
  auto options = std::make_shared<SoilOptions>();
  CLI::App* command = identify.add_subcommand("soil", "Tell from forces on a tool what soil it moved through");
  command->footer(kExamples);
  command
      ->add_option(
          "measured", options->measured_file,
          "Table with t_s, x_m, y_m, z_m, qw, qx, qy, qz, soil_fx_n, soil_fy_n, soil_fz_n: where the tool was,\n"
          "and the force of the soil on it")
      ->option_text("FILE.csv")
      ->required();
  command->add_option("--training", options->training_file, "What soils do to this tool along this movement")
      ->option_text("FILE.json [the probe's]");
  command->add_option("--origin-mm", options->origin_mm, "Where the middle of the soil's surface was in that frame")
      ->option_text("X,Y,Z [0,0,0]")
      ->delimiter(',')
      ->expected(3)
      ->check(numberIn({-1e5, 1e5}));
  command->add_option("--body", options->body, "Ceres, Pluto, Europa, Moon, Mars or Earth")->capture_default_str();
  command->add_option("--density-kg-m3", options->density_kg_m3, "Its density in bulk, for --soil-out")
      ->option_text("RHO [1500]")
      ->check(numberIn({1000, 2500}));
  command->add_option("--soil-out", options->soil_out, "Write soil that behaves so, for scenes")
      ->option_text("FILE.toml");
  command->add_option("--radius-mm", options->radius_mm, "Radius of its grains")
      ->option_text("R [5]")
      ->check(numberIn({0.5, 20}));
  options->overwrite.addTo(*command);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { identifySoil(*options); });
}

}  // namespace haptolith
