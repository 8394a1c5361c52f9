// The soil laboratory, and the calibration of soils.

#include <fmt/format.h>
#include <haptolith/haptolith.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/c_api/errors.h"
#include "haptolith/c_api/result.h"
#include "haptolith/c_api/scene_object.h"
#include "haptolith/c_api/soil_object.h"
#include "haptolith/c_api/values.h"
#include "haptolith/lab/catalogue/lab_test.h"
#include "haptolith/lab/catalogue/option_reader.h"
#include "haptolith/lab/report/calibrate_soil.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/trust/trust_schedule.h"

using namespace haptolith;
using namespace haptolith::library;

namespace {

int allThreads() {
  return static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 256U));
}

/// Arguments common to every test.
struct Circumstances {
  SoilChanges soil;
  double gravity_m_s2 = LabConditions().gravity_m_s2;
  std::uint64_t seed = 1;
  int threads = allThreads();
};

/// Gravity of a body, or by its number.
std::vector<LabOption> gravityOptions(double& gravity_m_s2) {
  return {numberOption("gravity_m_s2", gravity_m_s2, ""),
          wordOption(
              "body", {}, "Moon",
              [&gravity_m_s2](std::string_view name) { gravity_m_s2 = findBody(name).gravity_m_s2; }, "")};
}

std::vector<LabOption> together(std::vector<LabOption> a, const std::vector<LabOption>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::vector<LabOption> optionsOf(Circumstances& c) {
  const auto number = [](const char* key, std::optional<double>& value) {
    return LabOption{
        .key = key, .help = "", .usual = "", .set = LabOption::Number([&value](double given) { value = given; })};
  };
  const auto set_friction = [&c](std::string_view word) { c.soil.friction = valueOf(kFrictionWords, word); };
  return together(
      {number("radius_mm", c.soil.radius_mm), number("stiffness_n_m", c.soil.stiffness_n_m),
       wordOption("friction_model", {"icra2021", "contact"}, "", set_friction, ""),
       seedOption("seed", c.seed, BedRanges::seed, ""), countOption("threads", c.threads, BedRanges::threads, "")},
      gravityOptions(c.gravity_m_s2));
}

nlohmann::ordered_json jsonOf(const Finding& finding) {
  nlohmann::ordered_json json{{"measured", finding.measured}, {"target", finding.target}, {"unit", finding.unit}};
  json["number"] = std::isfinite(finding.number) ? nlohmann::ordered_json(finding.number) : nullptr;
  if (finding.accepted) {
    json["passes"] = finding.accepted->contains(finding.number);
  }
  return json;
}

Result resultOf(LabOutput output) {
  Result result{.json = std::move(output.json)};
  for (const Finding& finding : output.findings) {
    result.json["findings"].push_back(jsonOf(finding));
  }
  result.names = output.trace.columns;
  result.columns.resize(result.names.size());
  for (const std::vector<double>& row : output.trace.rows) {
    for (std::size_t i = 0; i < result.names.size() && i < row.size(); ++i) {
      result.columns[i].push_back(row[i]);
    }
  }
  return result;
}

/// Request of a calibration.
struct CalibrationAsked {
  SoilTarget target;
  CalibrateSoilOptions options;
  std::string name = "calibrated", source;
};

std::vector<LabOption> optionsOf(CalibrationAsked& asked) {
  SoilTarget& target = asked.target;
  CalibrateSoilOptions& o = asked.options;
  const auto set_strength = [&target](std::string_view word) { target.strength = valueOf(kSoilStrengthWords, word); };
  const auto set_density = [&o](std::string_view word) {
    o.density = word == "constant" ? DensityProfile::kConstant : DensityProfile::kLunar;
  };
  return together(
      {numberOption("friction_angle_deg", target.friction_angle_deg, ""),
       numberOption("cohesion_pa", target.cohesion_pa, ""),
       numberOption("bulk_density_kg_m3", target.bulk_density_kg_m3, ""),
       wordOption("strength", {"residual", "peak"}, "residual", set_strength, ""),
       wordOption("density", {"lunar", "constant"}, "lunar", set_density, ""),
       millimetresOption("radius_mm", o.radius_m, ""), numberOption("stiffness_n_m", o.stiffness_n_m, ""),
       seedOption("seed", o.seed, BedRanges::seed, ""), countOption("threads", o.threads, BedRanges::threads, ""),
       countOption("specimens", o.verification_seeds, CalibrateSoilRanges::verification_seeds, ""),
       textOption("name", asked.name, ""), textOption("source", asked.source, "")},
      gravityOptions(o.gravity_m_s2));
}

}  // namespace

std::int32_t hapto_scene_trust(const hapto_scene* scene, const char* options, hapto_progress told, void* user,
                               hapto_result** out) {
  if (out == nullptr) {
    return wrongArgument(HAPTO_NULL, "out");
  }
  const Claim claim(scene);
  if (claim.status() != HAPTO_OK) {
    return wrongArgument(claim.status(), "scene");
  }
  Progress progress(told, user);
  return progress.status([&] {
    readEnvironment();
    SceneFile scene_file = claim->sceneFile();
    TrustExtent extent{.duration_s = usualDuration(scene_file), .threads = allThreads(), .only = {}};
    std::string tool(scene_file.tool_name);
    readOptions(textOrNothing(options),
                {textOption("tool", tool, ""), numberOption("duration_s", extent.duration_s, ""),
                 numberOption("minutes", extent.minutes, ""),
                 countOption("specimens", extent.specimens, TrustExtent::kSpecimens, ""),
                 countOption("threads", extent.threads, BedRanges::threads, "")});
    exchangeFirst(scene_file, toolNumber(scene_file, tool));
    const TrustVerdict verdict = examined(
        scene_file, extent, [&progress](std::string_view what, double share) { return progress.tell(what, share); });
    *out = handleOf({.json = trustJson(verdict)});
    return HAPTO_OK;
  });
}

std::int32_t hapto_lab_test(const char* test, const hapto_soil* soil, const char* options, hapto_progress told,
                            void* user, hapto_result** out) {
  if (test == nullptr || out == nullptr) {
    return wrongArgument(HAPTO_NULL, test == nullptr ? "test" : "out");
  }
  const Claim claim(soil);
  if (claim.status() != HAPTO_OK) {
    return wrongArgument(claim.status(), "soil");
  }
  Progress progress(told, user);
  return progress.status([&] {
    readEnvironment();
    const LabTest chosen = labTest(test);
    Circumstances circumstances;
    readOptions(textOrNothing(options), together(chosen.options, optionsOf(circumstances)));
    const LabSoil specimen{claim->name, soilForTest(claim->soil, chosen.radius_mm, circumstances.soil),
                           claim->file ? std::optional(claim->file->target) : std::nullopt};
    const LabConditions conditions{
        .soil = specimen.soil,
        .gravity_m_s2 = circumstances.gravity_m_s2,
        .seed = circumstances.seed,
        .threads = circumstances.threads,
        .progress = [&progress](std::string_view what, double share) { return progress.tell(what, share); }};
    *out = handleOf(resultOf(chosen.run(specimen, conditions)));
    return HAPTO_OK;
  });
}

std::int32_t hapto_soil_calibrate(const char* target, hapto_progress told, void* user, hapto_soil** out,
                                  hapto_result** report) {
  if (target == nullptr || out == nullptr) {
    return wrongArgument(HAPTO_NULL, target == nullptr ? "target" : "out");
  }
  Progress progress(told, user);
  return progress.status([&]() -> std::int32_t {
    readEnvironment();
    CalibrationAsked asked;
    asked.options.threads = Circumstances().threads;
    readOptions(textOrNothing(target), optionsOf(asked));
    asked.options.progress = [&progress](std::string_view what, double share) { return progress.tell(what, share); };
    const CalibratedSoil made = calibrateSoil(asked.target, asked.options);
    auto soil = std::make_unique<NamedSoil>(
        NamedSoil{asked.name, made.soil, SoilFile{asked.name, asked.source, asked.target, made.soil, made.reached}});
    if (report != nullptr) {
      Result result;
      result.json = {{"friction_angle_deg", made.reached.friction_angle_deg},
                     {"friction_angle_sd_deg", made.reached.friction_angle_sd_deg},
                     {"cohesion_pa", made.reached.cohesion_pa},
                     {"cohesion_sd_pa", made.reached.cohesion_sd_pa},
                     {"bulk_density_kg_m3", made.reached.bulk_density_kg_m3},
                     {"seeds", made.reached.seeds},
                     {"rounds", made.rounds}};
      *report = handleOf(std::move(result));
    }
    *out = Places<hapto_soil>::take(std::move(soil));
    return HAPTO_OK;
  });
}
