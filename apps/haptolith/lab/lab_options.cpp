#include "lab/lab_options.h"

#include <CLI/App.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <thread>
#include <utility>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/overloaded.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/scene_file/soil_file_keys.h"
#include "haptolith/scene_file/toml/toml_writer.h"
#include "haptolith/soil/bodies.h"

#include "shared/common_options.h"
#include "shared/option_checks.h"

namespace haptolith {

namespace {

constexpr double kMm = 1e-3;

/// Returns a transform to lower case.
CLI::Validator inLowerCase() {
  return {[](std::string& text) {
            text = CLI::detail::to_lower(text);
            return std::string();
          },
          ""};
}

}  // namespace

int threadsFor(int wanted) {
  return wanted > 0 ? wanted : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

void LabOptions::addTo(CLI::App& command) {
  command.add_option("--soil", soil, kSoilHelp)->capture_default_str();
  std::map<std::string, FrictionModel> models;
  for (const auto& word : kFrictionWords) {
    models.emplace(word.name, word.value);
  }
  command.add_option("--friction-model", friction, "Friction model [the soil's]")->transform(wordOf(models));
  command.add_option("--body", body, kBodyHelp)->capture_default_str();
  command.add_option("--radius-mm", radius_mm, "Radius of a particle in mm; the bulk soil stays the same [the test's]");
  command.add_option("--stiffness-n-m", stiffness_n_m, "Contact stiffness at that radius [the soil's]");
  command.add_option("--seed", seed, "Seed of the specimen")
      ->check(wholeNumberIn(BedRanges::seed))
      ->capture_default_str();
  command.add_option("--threads", threads, fmt::format("{} [all]", kThreadsHelp))
      ->check(wholeNumberIn(BedRanges::threads));
  command.add_option("--figure", figure_file, kFigureHelp);
  command.add_option("--trace", trace_file, "Write the simulated values over time (.csv)");
  overwrite.addTo(command);
  addJson(command, json);
}

std::string flagOf(const LabOption& option) {
  std::string flag = "--" + option.key;
  std::ranges::replace(flag, '_', '-');
  return flag;
}

void addOption(CLI::App& command, const LabOption& option) {
  const std::string flag = flagOf(option);
  const std::string help = option.usual.empty() ? option.help : fmt::format("{} [{}]", option.help, option.usual);
  const auto add =
      Overloaded{[&](const LabOption::Number& set) { command.add_option_function<double>(flag, set, help); },
                 [&](const LabOption::List& set) {
                   command.add_option_function<std::vector<double>>(flag, set, help)->delimiter(',');
                 },
                 [&](const LabOption::Switch& set) { command.add_flag_callback(flag, set, help); },
                 [&](const LabOption::Count& count) {
                   command.add_option_function<std::int64_t>(flag, count.set, help)->check(wholeNumberIn(count.valid));
                 },
                 [&](const LabOption::Word& word) {
                   if (word.words.empty()) {
                     command.add_option_function<std::string>(flag, word.set, help)->option_text("FILE");
                     return;
                   }
                   command.add_option_function<std::string>(flag, word.set, help)
                       ->transform(inLowerCase())
                       ->check(oneOf(word.words));
                 }};
  std::visit(add, option.set);
}

LabSoil labSoil(const LabOptions& options, double radius_mm) {
  const NamedSoil found = findSoilOrPreset(options.soil);
  return {found.name,
          soilForTest(
              found.soil, radius_mm,
              {.radius_mm = options.radius_mm, .stiffness_n_m = options.stiffness_n_m, .friction = options.friction}),
          found.file ? std::optional(found.file->target) : std::nullopt};
}

LabConditions labConditions(const LabOptions& options, const LabSoil& soil, LabProgress progress) {
  LabConditions conditions;
  conditions.soil = soil.soil;
  conditions.gravity_m_s2 = findBody(options.body).gravity_m_s2;
  conditions.seed = options.seed;
  conditions.threads = threadsFor(options.threads);
  conditions.progress = std::move(progress);
  return conditions;
}

nlohmann::ordered_json circumstancesJson(const LabOptions& options, const LabSoil& soil,
                                         const LabConditions& conditions) {
  return {{"soil", soil.name},
          {"friction", wordFor(kFrictionWords, conditions.soil.friction)},
          {"body", findBody(options.body).name},
          {"gravity_m_s2", conditions.gravity_m_s2},
          {"radius_mm", conditions.soil.radius_m / kMm},
          {"stiffness_n_m", conditions.soil.stiffness_n_m},
          {"seed", conditions.seed}};
}

std::string circumstancesText(const LabOptions& options, const LabSoil& soil, const LabConditions& conditions) {
  return fmt::format("{}, {} friction, {}, particles of R = {:.3g} mm, seed {}", soil.name,
                     wordFor(kFrictionWords, conditions.soil.friction), findBody(options.body).name,
                     conditions.soil.radius_m / kMm, conditions.seed);
}

nlohmann::ordered_json soilJson(const SoilParameters& soil) {
  SceneFile scene;
  scene.bed.soil = soil;
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const SceneFileKey& key : soilKeys()) {
    const std::string line = tomlLine(key, scene);
    if (const std::size_t equals = line.find(" = "); equals != std::string::npos && key.name != "friction_model") {
      json[std::string(key.name)] = line.substr(equals + 3, line.size() - equals - 4);
    }
  }
  return json;
}

nlohmann::ordered_json targetJson(const std::optional<SoilTarget>& target) {
  if (!target) {
    return nullptr;
  }
  return {{"bulk_density_kg_m3", target->bulk_density_kg_m3},
          {"friction_angle_deg", target->friction_angle_deg},
          {"cohesion_pa", target->cohesion_pa},
          {"strength", wordFor(kSoilStrengthWords, target->strength)}};
}

void requireWritable(const std::vector<OutputFile>& files) {
  for (const OutputFile& file : files) {
    if (!file.path.empty()) {
      const AtomicFile left_unfinished(file);
    }
  }
}

void saveTrace(const OutputFile& file, const LabTrace& trace) {
  AtomicFile whole(file);
  whole.write(fmt::format("{}\n", fmt::join(trace.columns, ",")));
  for (const std::vector<double>& row : trace.rows) {
    whole.write(fmt::format("{:.7g}\n", fmt::join(row, ",")));
  }
  whole.commit();
}

}  // namespace haptolith
