#include "haptolith/scene_file/soil_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <span>
#include <utility>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/nearest_word.h"
#include "haptolith/scene_file/built_in_soils.h"
#include "haptolith/scene_file/key_use.h"
#include "haptolith/scene_file/soil_file_keys.h"
#include "haptolith/scene_file/toml/toml_reader.h"
#include "haptolith/scene_file/toml/toml_writer.h"
#include "haptolith/soil/presets.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

constexpr FileKind kSoil{.name = "soil",
                         .example_key = "name",
                         .document = "docs/reference/soils.md",
                         .left_out = "left out, so the default"};

// --- reading --------------------------------------------------------------------------------------------------------

/// Required keys: without them a file would silently be half a soil.
void requireKeys(const TomlReader& reader, const SoilParameters& soil) {
  reader.require("", "name");
  for (const char* measured : {"bulk_density_kg_m3", "friction_angle_deg", "cohesion_pa"}) {
    reader.require("target", measured);
  }
  for (const SceneFileKey& key : soilKeys()) {
    const auto* number = std::ranges::find(kSoilNumbers, key.parameter, &SoilNumber::key);
    const bool is_friction = number == kSoilNumbers.end();
    if (is_friction || (number->role != SoilRole::kUsual && number->isUsedBy(soil.friction))) {
      reader.require("soil", key.name);
    }
  }
  for (const SoilFileKey& key : soilFileKeys()) {
    if (key.table == "reached" && reader.has("reached")) {
      reader.require(key.table, key.name);
    }
  }
}

void requireInside(std::string_view key, double value, const std::optional<Range>& range) {
  if (range) {
    requireInRange(key, value, *range);
  }
}

void validateWhole(const TomlReader& reader, const SoilFile& file) {
  const SoilTarget& target = file.target;
  reader.check(soilFileKeys(), "target", [&] {
    requireInside("friction_angle_deg", target.friction_angle_deg, target.friction_angle_range_deg);
    requireInside("cohesion_pa", target.cohesion_pa, target.cohesion_range_pa);
  });
  reader.check(soilKeys(), "soil", [&] { validate(file.soil); });
}

SoilFile read(const TomlReader& reader) {
  std::vector<KeyName> known = keyNames(soilFileKeys());
  std::ranges::copy(keyNames(soilKeys()), std::back_inserter(known));
  reader.refuseUnknownKeys(known);
  SoilFile file;
  for (const SoilFileKey& key : soilFileKeys()) {
    reader.apply(key, file);
  }
  // [soil] means what it means in a scene, so it is read into one.
  SceneFile scene;
  for (const SceneFileKey& key : soilKeys()) {
    reader.apply(key, scene);
  }
  file.soil = scene.bed.soil;
  requireKeys(reader, file.soil);
  validateWhole(reader, file);
  return file;
}

// --- writing --------------------------------------------------------------------------------------------------------

std::string linesOf(std::string_view table, const SoilFile& file) {
  std::string lines;
  for (const SoilFileKey& key : soilFileKeys()) {
    lines += key.table == table ? tomlLine(key, file) : "";
  }
  return lines;
}

/// Whether only the friction model that this soil does not have uses the key.
bool isOfOtherModel(std::string_view key, const SceneFile& scene) {
  return std::ranges::any_of(
      keyUses(), [&](const KeyUse& use) { return use.table == "soil" && use.name == key && !use.counts(scene); });
}

/// Numbers of the other friction model are left out unless they were set.
std::string soilLines(const SoilParameters& soil) {
  const SceneFile defaults;
  SceneFile scene;
  scene.bed.soil = soil;
  std::string lines;
  for (const SceneFileKey& key : soilKeys()) {
    if (!isOfOtherModel(key.name, scene) || tomlLine(key, scene) != tomlLine(key, defaults)) {
      lines += tomlLine(key, scene);
    }
  }
  return lines;
}

std::string textOf(const SoilFile& file) {
  std::string text = fmt::format(
      "{}\n"
      "# Reference: engineering properties.\n[target]\n{}\n"
      "# Calibrated parameters of the particles.\n[soil]\n{}",
      linesOf("", file), linesOf("target", file), soilLines(file.soil));
  if (file.reached) {
    text += fmt::format("\n# Simulated properties after `haptolith soil calibrate`.\n[reached]\n{}",
                        linesOf("reached", file));
  }
  return text;
}

// --- finding --------------------------------------------------------------------------------------------------------

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

[[noreturn]] void refuseSoilName(std::string_view name) {
  std::vector<std::string_view> names;
  for (const BuiltInSoil& soil : builtInSoils()) {
    names.push_back(soil.name);
  }
  const std::string_view nearest = nearestWord(lowerCase(name), names);
  throw InvalidParameter("soil", fmt::format("'{}'", name),
                         fmt::format("one of {}, or a soil file (.toml){}", fmt::join(names, ", "),
                                     nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
}

}  // namespace

SoilFile loadSoilFile(const fs::path& path) {
  return read(TomlReader(path, kSoil));
}

SoilFile soilFileFromText(std::string_view text, std::string_view name) {
  return read(TomlReader(name, text, kSoil));
}

std::string soilFileText(const SoilFile& soil) {
  std::string text = textOf(soil);
  static_cast<void>(soilFileFromText(text, "the soil as text"));  // an unreadable text is not written
  return text;
}

SoilFile findSoil(std::string_view name_or_file) {
  for (const BuiltInSoil& soil : builtInSoils()) {
    if (lowerCase(name_or_file) == soil.name) {
      return read(TomlReader(fmt::format("soils/{}.toml", soil.name), soil.text, kSoil));
    }
  }
  std::error_code error;
  if (name_or_file.ends_with(".toml") || fs::is_regular_file(name_or_file, error)) {
    return loadSoilFile(name_or_file);
  }
  refuseSoilName(name_or_file);
}

NamedSoil findSoilOrPreset(std::string_view name_or_file) {
  const auto is_named = [&](const Preset& preset) { return lowerCase(preset.name) == lowerCase(name_or_file); };
  if (std::ranges::any_of(presets(), is_named)) {
    const Preset& preset = findPreset(name_or_file);
    return {std::string(preset.name), preset.soil, std::nullopt};
  }
  SoilFile file = findSoil(name_or_file);
  return {file.name, file.soil, std::move(file)};
}

std::vector<std::string> soilNames() {
  std::vector<std::string> names;
  for (const BuiltInSoil& soil : builtInSoils()) {
    names.emplace_back(soil.name);
  }
  return names;
}

void saveSoilFile(const fs::path& path, const SoilFile& soil) {
  const std::string text = soilFileText(soil);
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace haptolith
