#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "haptolith/core/former_names.h"
#include "haptolith/core/nearest_word.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/scene_file/built_in_scenes.h"
#include "haptolith/scene_file/key_use.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/scene_file_keys.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/stone_keys.h"
#include "haptolith/scene_file/toml/toml_error.h"
#include "haptolith/scene_file/toml/toml_reader.h"
#include "haptolith/scene_file/toml/toml_writer.h"
#include "haptolith/scene_file/tool_part_keys.h"

namespace haptolith {

namespace {

constexpr FileKind kScene{.name = "scene",
                          .example_key = "title",
                          .document = "docs/reference/scenes.md",
                          .left_out = "left out, so as in icra2021"};

/// Keys of a tool that say which shape it has, in one way or another.
bool saysWhichShape(std::string_view key) {
  return key == "shape" || key == "model" || key == "tool_part" || key.starts_with("mesh");
}

constexpr RivalKeys kRivals[]{
    {"soil", "preset", "name"},
    {"soil", "preset", "file"},
    {"soil", "name", "file"},
    {"bed", "grains", "grains_data"},
    {"tool", "mesh", "mesh_data"},
    {"tool", "model", "mesh"},
    {"tool", "model", "mesh_data"},
    {"tool", "model", "shape"},
    {"gravity", "body", "magnitude_m_s2"},
    {"gravity", "vector_m_s2", "direction"},
    {"gravity", "vector_m_s2", "body"},
    {"gravity", "vector_m_s2", "magnitude_m_s2"},
};

/// Those, and ways to choose a soil in addition to its numbers.
std::span<const RivalKeys> rivalKeys() {
  static const std::vector<RivalKeys> kAll = [] {
    std::vector<RivalKeys> all;
    for (const std::string_view choice : {"preset", "name", "file"}) {
      for (const SoilNumber& number : kSoilNumbers) {
        if (choice == "preset" ? number.makesPreset() : number.role == SoilRole::kDefining) {
          all.push_back({"soil", choice, number.key});
        }
      }
    }
    all.insert(all.end(), std::begin(kRivals), std::end(kRivals));
    return all;
  }();
  return kAll;
}

void refuseContradictions(const TomlReader& reader) {
  for (const RivalKeys& rivals : rivalKeys()) {
    reader.refuseBoth(rivals);
  }
  const toml::node* motion = reader.find("hand", "motion");
  if (motion != nullptr && motion->value_or(std::string_view()) != "poses") {
    reader.refuseBoth("hand", "poses", "motion");
  }
  const toml::node* shape = reader.find("tool", "shape");
  if (shape != nullptr && shape->value_or(std::string_view()) != "mesh") {
    reader.refuseBoth("tool", "mesh", "shape");
  }
  const toml::node* start = reader.find("bed", "start");
  if (start != nullptr && start->value_or(std::string_view()) != "given") {
    reader.refuseBoth("bed", "grains", "start");
  }
}

/// With the line of the key that brought the mesh, of what is wrong in its file.
void makeMesh(const TomlReader& reader, SceneFile& scene) {
  try {
    makeToolMesh(scene);
  } catch (const InvalidParameter& error) {
    for (const KeyName& key : {KeyName{"tool", "mesh"}, KeyName{"tool", "mesh_data"}, KeyName{"", "tool_part"}}) {
      if (reader.find(key.table, key.name) != nullptr) {
        throw TomlError(reader.located(key, error.what()), reader.lineOf(key.table, key.name));
      }
    }
    throw;
  }
}

void requireMesh(const TomlReader& reader, const SceneFile& scene) {
  if (scene.tool.shape == ToolShape::kMesh && scene.mesh.bytes == nullptr) {
    reader.refuse(reader.lineOf("tool", "shape"),
                  "[tool] shape = 'mesh' needs [tool] mesh, an .stl, .obj, .glb or .gltf file");
  }
}

void requireGrains(const TomlReader& reader, const SceneFile& scene) {
  const bool asked = reader.find("bed", "grains") != nullptr || reader.find("bed", "grains_data") != nullptr;
  if (scene.bed.start == BedStart::kGiven && !asked) {
    reader.refuse(reader.lineOf("bed", "start"), "[bed] start = 'given' needs [bed] grains, a CSV file");
  }
}

void requirePoses(const TomlReader& reader, const SceneFile& scene) {
  if (scene.hand.motion == HandMotion::kPoses && reader.find("hand", "poses") == nullptr) {
    reader.refuse(reader.lineOf("hand", "motion"), "[hand] motion = 'poses' needs [hand] poses, a CSV file");
  }
}

void requireJoint(const TomlReader& reader, const SceneFile& scene) {
  const Drive drive = scene.tool.joint.drive;
  if (drive == Drive::kNone || reader.find("tool", "joint_drive") == nullptr) {
    return;
  }
  const auto require = [&](std::string_view key, std::string_view what) {
    if (reader.find("tool", key) == nullptr) {
      reader.refuse(reader.lineOf("tool", "joint_drive"), fmt::format("[tool] joint_drive = '{}' needs [tool] {}, {}",
                                                                      wordFor(kDriveWords, drive), key, what));
    }
  };
  require("joint_axis", "the direction of the axis");
  if (drive == Drive::kTorque || drive == Drive::kFree) {
    require("joint_inertia_kg_m2", "the moment of inertia about the axis");
  }
}

void validateTool(const TomlReader& reader, const SceneFile& scene) {
  const std::span<const SceneFileKey> keys = sceneFileKeys();
  reader.check(keys, "tool", [&] { validate(scene.mesh); });
  reader.check(keys, "tool", [&] { validate(scene.tool); });
  reader.check(keys, "hand", [&] { validate(scene.hand); });
  reader.check(keys, "device", [&] { validate(scene.device); });
  reader.check(keys, "mapping", [&] { validate(scene.handling.mapping); });
  reader.check(keys, "coupling", [&] { validate(scene.handling.coupling, scene.loop.tick_s); });
  reader.check(keys, "safety", [&] { validate(scene.handling.safety); });
}

void validateWhole(const TomlReader& reader, const SceneFile& scene) {
  const std::span<const SceneFileKey> keys = sceneFileKeys();
  reader.check(keys, "soil", [&] { validate(scene.bed.soil); });
  reader.check(keys, "stones", [&] { validate(scene.bed.stones); });
  reader.check(keys, "bed", [&] { validate(scene.bed); });
  reader.check(keys, "loop", [&] { validate(scene.loop); });
  if (scene.more_tools.empty()) {
    validateTool(reader, scene);
  }
  reader.check(keys, "", [&] { validate(scene); });
}

/// Whether the file gives a key a value that is not the usual one and has no effect in `scene`.
bool isIdle(const TomlReader& reader, const KeyUse& use, const SceneFile& scene) {
  if (reader.findOwn(use.table, use.name) == nullptr || use.counts(scene)) {
    return false;
  }
  const auto keys = sceneFileKeys();
  const auto key = std::ranges::find_if(
      keys, [&](const SceneFileKey& known) { return known.table == use.table && known.name == use.name; });
  return tomlLine(*key, scene) != tomlLine(*key, SceneFile{});
}

std::string whyIdle(const KeyUse& use) {
  return fmt::format("[{}] {} has no effect: it needs {}", use.table, use.name, use.needs);
}

/// Whose keys are looked at: of a file with [[tools]], those of the scene, or of a tool.
enum class Whose { kAny, kBed, kTool };

bool isLookedAt(const KeyUse& use, Whose whose) {
  return whose == Whose::kAny || (whose == Whose::kTool) == isToolTable(use.table);
}

void refuseWhatNeverCounts(const TomlReader& reader, const SceneFile& scene, Whose whose) {
  for (const KeyUse& use : keyUses()) {
    if (isLookedAt(use, whose) && !use.may_count_later && isIdle(reader, use, scene)) {
      reader.refuse(reader.lineOf(use.table, use.name), whyIdle(use));
    }
  }
}

/// Source of a scene's text: recordings and studies hold texts of earlier versions.
enum class From { kFile, kStored };

/// Scenes may be foreign, and a library is code: only the command line and the environment name one. Recordings
/// and studies of earlier versions may hold the key; it has no meaning any more.
constexpr KeyName kLibrary{"device", "library"};

void refuseLibrary(const TomlReader& reader) {
  if (reader.find(kLibrary.table, kLibrary.name) != nullptr) {
    reader.refuseKey(
        kLibrary,
        "left out: for security, scene files cannot name libraries; use --device-library PATH or FORCEDIM_SDK");
  }
}

constexpr KeyName kTools{"", "tools"};

std::string toolNameIn(const TomlReader& table) {
  static const SceneFileKey kName{"", "name", "",
                                  SceneFileKey::TextValue{[](SceneFile& scene, std::string_view name) {
                                                            requireToolName(name);
                                                            scene.tool_name = name;
                                                          },
                                                          kOnlyRead},
                                  "Name of the tool."};
  SceneFile named;
  table.apply(kName, named);
  return named.tool_name;
}

/// Reads the tool and what moves it, which are the first of `scene`.
void readFirstTool(const TomlReader& reader, SceneFile& scene) {
  for (const SceneFileKey& key : sceneFileKeys()) {
    if (isOfTool(key)) {
      reader.apply(key, scene);
    }
  }
  readToolParts(reader, scene);
  requirePoses(reader, scene);
  requireMesh(reader, scene);
  requireJoint(reader, scene);
}

/// A tool of [[tools]]: what it does not say itself, the file's [tool], [hand] and so on say of all.
/// @throws TomlError.
void readTool(TomlReader& reader, From from, SceneFile& scene) {
  std::vector<KeyName> known = keyNames(keysOfTools());
  known.push_back({"", "name"});
  known.push_back({"", "tool_part"});
  reader.refuseUnknownKeys(known);
  reader.decideTogether("tool", [](std::string_view key) { return saysWhichShape(key); });
  reader.decideTogether("hand", [](std::string_view key) { return key == "motion" || key == "poses"; });
  refuseContradictions(reader);
  readFirstTool(reader, scene);
  makeMesh(reader, scene);
  validateTool(reader, scene);
  if (from == From::kFile) {
    refuseWhatNeverCounts(reader, scene, Whose::kTool);
  }
}

void readNewTools(const TomlReader& reader, From from, SceneFile& scene) {
  std::vector<TomlReader> tables = reader.parts(kTools.name, "tool");
  if (tables.size() > ToolSet::kMost) {
    reader.refuse(tables[ToolSet::kMost].line(),
                  fmt::format("{} [[tools]] are not valid: must be at most {}", tables.size(), ToolSet::kMost));
  }
  const SceneFile usual;
  scene.more_tools.clear();
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::string name = toolNameIn(tables[i]);
    for (std::size_t before = 0; before < i; ++before) {
      if (toolNames(scene)[before] == name) {
        tables[i].refuseKey({"", "name"}, "another name than those of the tools before it");
      }
    }
    if (i == 0) {
      scene.tool_name = name;
    } else {
      scene.more_tools.push_back({name, usual.mesh, usual.tool, usual.hand, usual.device, usual.handling});
    }
    exchangeFirst(scene, i);
    readTool(tables[i], from, scene);
    exchangeFirst(scene, i);
  }
}

/// Changes tools that are there: all of them, and those with a name.
void changeTools(const TomlReader& reader, From from, SceneFile& scene) {
  for (std::size_t i = 0; i < toolCount(scene); ++i) {
    exchangeFirst(scene, i);
    readFirstTool(reader, scene);
    exchangeFirst(scene, i);
  }
  for (TomlReader& table : reader.parts(kTools.name, "tool")) {
    const std::size_t i = toolNumber(scene, toolNameIn(table));
    exchangeFirst(scene, i);
    readTool(table, from, scene);
    exchangeFirst(scene, i);
  }
}

/// @param scene  what keys that are left out keep.
SceneFile read(const TomlReader& reader, From from, SceneFile scene = {}) {
  std::vector<KeyName> known = keyNames(sceneFileKeys());
  known.push_back(kLibrary);
  known.push_back({"", "stone"});  // a separate table for each
  known.push_back({"", "tool_part"});
  known.push_back(kTools);
  reader.refuseUnknownKeys(known);
  if (from == From::kFile) {
    refuseLibrary(reader);
  }
  const bool has_tools = reader.has(kTools.table, kTools.name);
  if (!has_tools) {
    refuseContradictions(reader);
  }
  for (const SceneFileKey& key : sceneFileKeys()) {
    if (!isOfTool(key)) {
      reader.apply(key, scene);
    }
  }
  readPlacedStones(reader, scene);
  requireGrains(reader, scene);
  if (reader.isChange()) {
    changeTools(reader, from, scene);
  } else if (has_tools) {
    readNewTools(reader, from, scene);
  } else {
    readFirstTool(reader, scene);
  }
  makeMesh(reader, scene);
  validateWhole(reader, scene);
  if (from == From::kFile) {
    refuseWhatNeverCounts(reader, scene, has_tools ? Whose::kBed : Whose::kAny);
  }
  return scene;
}

// --- finding --------------------------------------------------------------------------------------------------------

[[noreturn]] void refuseSceneName(std::string_view name) {
  std::vector<std::string_view> names;
  names.reserve(builtInScenes().size());
  for (const BuiltInScene& scene : builtInScenes()) {
    names.push_back(scene.name);
  }
  const std::string_view nearest = nearestWord(name, names);
  throw InvalidParameter("scenario", fmt::format("'{}'", name),
                         fmt::format("one of {}, or a scene file (.toml){}", fmt::join(names, ", "),
                                     nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
}

TomlReader readerOf(std::string_view name_or_file) {
  const std::string_view name = currentNameReported(NameKind::kScene, name_or_file);
  for (const BuiltInScene& scene : builtInScenes()) {
    if (name == scene.name) {
      return {fmt::format("scenes/{}.toml", scene.name), scene.text, kScene};
    }
  }
  std::error_code error;
  if (!name_or_file.ends_with(".toml") && !std::filesystem::exists(name_or_file, error) && !error) {
    refuseSceneName(name_or_file);
  }
  return {name_or_file, kScene};
}

/// A shape takes the place of the file's mesh, and a mesh that of its shape and of the mesh that it had; either that of
/// the parts that it is put together of.
void takeToolOverrides(TomlReader& reader, const TomlReader& given) {
  const toml::node* shape = given.find("tool", "shape");
  const bool other_mesh = given.has("tool", "mesh") || given.has("tool", "model");
  const bool other_shape = shape != nullptr && shape->value_or(std::string_view()) != "mesh";
  if (other_mesh || other_shape) {
    reader.passOver("", [](std::string_view key) { return key == "tool_part"; });
  }
  if (other_mesh) {
    reader.passOver("tool", [](std::string_view key) { return key == "shape" || key.starts_with("mesh"); });
  } else if (other_shape) {
    reader.passOver("tool", [](std::string_view key) { return key == "mesh" || key == "model"; });
  }
}

/// Replaces the file's soil, friction and stiffness included, except for the size of its particles; particles with
/// contact friction must not begin as a crystal (see setSoil()).
void takeOverrides(TomlReader& reader, std::span<const std::string> overrides) {
  reader.takeOverrides(overrides, rivalKeys());
  const TomlReader given(overrides, kScene);
  takeToolOverrides(reader, given);
  const bool measured = given.has("soil", "name") || given.has("soil", "file");
  if (measured || given.has("soil", "preset")) {
    reader.passOver("soil", [](std::string_view key) { return key != "radius_mm"; });
  }
  const toml::node* start = reader.find("bed", "start");
  if (measured && start != nullptr && !given.has("bed", "start") && start->value_or(std::string_view()) == "count") {
    reader.passOver("bed", [](std::string_view key) { return key == "start"; });
  }
}

bool giveTitle(std::span<const std::string> overrides) {
  return TomlReader(overrides, kScene).has("", "title");
}

/// The scene with overrides; if they change things that its title may name, and give no title, it gets a new one.
/// @param reader_of  makes the reader of the scene as it is without them
template <class ReaderOf>
SceneFile readWithOverrides(const ReaderOf& reader_of, std::span<const std::string> overrides) {
  TomlReader reader = reader_of();
  takeOverrides(reader, overrides);
  SceneFile scene = read(reader, From::kFile);
  if (overrides.empty() || giveTitle(overrides)) {
    return scene;
  }
  std::string before;
  try {
    TomlReader own = reader_of();
    before = sceneInWords(read(own, From::kFile));
  } catch (const std::exception&) {  // a scene that is valid with the overrides alone
  }
  retitle(scene, before);
  return scene;
}

}  // namespace

SceneFile findSceneFile(std::string_view name_or_file, std::span<const std::string> overrides) {
  return readWithOverrides([name_or_file] { return readerOf(name_or_file); }, overrides);
}

SceneFile sceneFileFromText(std::string_view text, std::string_view name, std::span<const std::string> overrides) {
  return readWithOverrides(
      [&] {
        return text.empty() ? TomlReader(std::span<const std::string>(), kScene) : TomlReader(name, text, kScene);
      },
      overrides);
}

SceneFile changed(const SceneFile& scene_file, std::span<const std::string> overrides) {
  const TomlReader reader(overrides, kScene);
  SceneFile scene = read(reader, From::kFile, scene_file);
  const bool other_soil = reader.has("soil", "preset") || reader.has("soil", "name") || reader.has("soil", "file");
  if (other_soil && !reader.has("soil", "radius_mm")) {  // the grains that are there
    scene.bed.soil = rescaled(scene.bed.soil, scene_file.bed.soil.radius_m);
    scene.bed.start = scene_file.bed.start;
    makeToolMesh(scene);
  }
  if (reader.has("soil", "preset")) {
    scene.soil_name.clear();
  }
  if (!reader.has("", "title")) {
    retitle(scene, sceneInWords(scene_file));
  }
  return scene;
}

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  names.reserve(builtInScenes().size());
  for (const BuiltInScene& scene : builtInScenes()) {
    names.emplace_back(scene.name);
  }
  return names;
}

std::vector<std::string> idleKeys(std::string_view name_or_file, const SceneFile& scene,
                                  std::span<const std::string> overrides) {
  TomlReader reader = readerOf(name_or_file);
  takeOverrides(reader, overrides);
  std::vector<std::string> idle;
  const auto look = [&](const TomlReader& at, const SceneFile& shown, Whose whose) {
    for (const KeyUse& use : keyUses()) {
      if (isLookedAt(use, whose) && isIdle(at, use, shown)) {
        idle.push_back(at.located({use.table, use.name}, whyIdle(use)));
      }
    }
  };
  if (!reader.has(kTools.table, kTools.name)) {
    look(reader, scene, Whose::kAny);
    return idle;
  }
  look(reader, scene, Whose::kBed);
  SceneFile each = scene;
  const std::vector<TomlReader> tables = reader.parts(kTools.name, "tool");
  for (std::size_t i = 0; i < std::min(tables.size(), toolCount(scene)); ++i) {
    exchangeFirst(each, i);
    look(tables[i], each, Whose::kTool);
    exchangeFirst(each, i);
  }
  return idle;
}

SceneFile loadSceneFile(const std::filesystem::path& path) {
  return read(TomlReader(path, kScene), From::kFile);
}

SceneFile loadSceneFileText(std::string_view text, std::string_view name) {
  return read(TomlReader(name, text, kScene), From::kStored);
}

}  // namespace haptolith
