#include "soil/named_soil_commands.h"

#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/soil_file.h"

#include "shared/common_options.h"
#include "shared/output.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

std::vector<SoilFile> namedSoils() {
  std::vector<SoilFile> soils;
  for (const std::string& name : soilNames()) {
    soils.push_back(findSoil(name));
  }
  return soils;
}

Json rangeOrNull(const std::optional<Range>& range) {
  return range ? Json{range->lowest, range->highest} : Json(nullptr);
}

Json soilJson(const SoilFile& soil) {
  const SoilTarget& target = soil.target;
  return {{"name", soil.name},
          {"bulk_density_kg_m3", target.bulk_density_kg_m3},
          {"friction_angle_deg", target.friction_angle_deg},
          {"friction_angle_range_deg", rangeOrNull(target.friction_angle_range_deg)},
          {"cohesion_pa", target.cohesion_pa},
          {"cohesion_range_pa", rangeOrNull(target.cohesion_range_pa)},
          {"strength", wordFor(kSoilStrengthWords, target.strength)},
          {"friction", wordFor(kFrictionWords, soil.soil.friction)},
          {"calibrated", soil.reached.has_value()},
          {"source", soil.source}};
}

void printSoilsJson() {
  Json rows = Json::array();
  for (const SoilFile& soil : namedSoils()) {
    rows.push_back(soilJson(soil));
  }
  printJson(Json{{"soils", rows}});
}

/// Returns the first characters of a text, without a partial UTF-8 character.
std::string beginningOf(const std::string& text, std::size_t letters) {
  std::size_t end = 0;
  for (; end < text.size(); ++end) {
    const bool begins_letter = (static_cast<unsigned char>(text[end]) & 0xC0U) != 0x80U;
    if (begins_letter && letters-- == 0) {
      return text.substr(0, end) + "...";
    }
  }
  return text;
}

void printSoilsText() {
  constexpr std::size_t kSourceLetters = 44;  // for lines of 100 characters
  fmt::print("Built-in soils and their measured properties. Details: haptolith soil show NAME\n\n");
  fmt::print("                        density    angle   cohesion\n");
  fmt::print("                          kg/m³        °         Pa   source\n");
  for (const SoilFile& soil : namedSoils()) {
    const SoilTarget& target = soil.target;
    fmt::print("  {:<20}   {:>6.0f}   {:>6.1f}   {:>8.0f}   {}\n", soil.name, target.bulk_density_kg_m3,
               target.friction_angle_deg, target.cohesion_pa, beginningOf(soil.source, kSourceLetters));
  }
}

void addList(CLI::App& soil) {
  auto json = std::make_shared<bool>(false);
  CLI::App* command = soil.add_subcommand("list", "List the built-in soils and their measured properties");
  addJson(*command, *json);
  command->footer("Examples:\n  haptolith soil list\n  haptolith run --soil lunar-0-15cm");
  command->callback([json] { *json ? printSoilsJson() : printSoilsText(); });
}

std::string rangeText(const std::optional<Range>& range) {
  return range ? fmt::format(" ({:g} to {:g})", range->lowest, range->highest) : "";
}

void printSoil(const SoilFile& soil) {
  const SoilTarget& target = soil.target;
  fmt::print("{}\n  source          {}\n", soil.name, soil.source);
  fmt::print("  bulk density    {:.0f} kg/m³\n", target.bulk_density_kg_m3);
  fmt::print("  friction angle  {:.1f}°{}, {}\n", target.friction_angle_deg, rangeText(target.friction_angle_range_deg),
             wordFor(kSoilStrengthWords, target.strength));
  fmt::print("  cohesion        {:.0f} Pa{}\n", target.cohesion_pa, rangeText(target.cohesion_range_pa));
  if (soil.reached) {
    fmt::print("  simulated       {:.1f} ± {:.1f}°, {:.0f} ± {:.0f} Pa, {:.0f} kg/m³ ({} specimens)\n",
               soil.reached->friction_angle_deg, soil.reached->friction_angle_sd_deg, soil.reached->cohesion_pa,
               soil.reached->cohesion_sd_pa, soil.reached->bulk_density_kg_m3, soil.reached->seeds);
  }
  fmt::print("  particles       R = {:g} mm, {} friction\n", soil.soil.radius_m * 1e3,
             wordFor(kFrictionWords, soil.soil.friction));
}

void addShow(CLI::App& soil) {
  struct Options {
    std::string name;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = soil.add_subcommand("show", "Show the properties and source of a soil");
  command->add_option("name", options->name, "Soil: a name (haptolith soil list) or a soil file")
      ->required()
      ->option_text("NAME|FILE");
  addJson(*command, options->json);
  command->footer("Example:\n  haptolith soil show lunar-0-15cm");
  command->callback([options] {
    const SoilFile found = findSoil(options->name);
    options->json ? printJson(soilJson(found)) : printSoil(found);
  });
}

}  // namespace

void addNamedSoilCommands(CLI::App& soil) {
  addList(soil);
  addShow(soil);
}

}  // namespace haptolith
