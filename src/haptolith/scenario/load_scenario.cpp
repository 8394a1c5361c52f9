#include "haptolith/scenario/scenario.h"
#include "haptolith/scenario/scenario_keys.h"
#include "haptolith/scenario/toml_reader.h"

namespace haptolith {

namespace {

constexpr FileKind kScene{
    .name = "scene", .example_key = "title", .document = "docs/scenarios.md", .left_out = "left out, so the paper's"};

void refuseContradictions(const TomlReader& reader) {
  for (const char* number : {"gamma_nm", "rho0_kg_m3", "rho_max_kg_m3", "mu_hat"}) {
    reader.refuseBoth("soil", "preset", number);
    reader.refuseBoth("soil", "name", number);
    reader.refuseBoth("soil", "file", number);
  }
  for (const char* number : {"contact_friction", "contact_cohesion_n"}) {  // a preset has none
    reader.refuseBoth("soil", "name", number);
    reader.refuseBoth("soil", "file", number);
  }
  reader.refuseBoth("soil", "preset", "name");
  reader.refuseBoth("soil", "preset", "file");
  reader.refuseBoth("soil", "name", "file");
  reader.refuseBoth("gravity", "body", "magnitude_m_s2");
  for (const char* part : {"direction", "body", "magnitude_m_s2"}) {
    reader.refuseBoth("gravity", "vector_m_s2", part);
  }
  const toml::node* manoeuvre = reader.find("hand", "manoeuvre");
  if (manoeuvre != nullptr && manoeuvre->value_or(std::string_view()) != "poses") {
    reader.refuseBoth("hand", "poses", "manoeuvre");
  }
}

void requirePoses(const TomlReader& reader, const Scenario& scene) {
  if (scene.hand.manoeuvre == Manoeuvre::kPoses && reader.find("hand", "poses") == nullptr) {
    reader.refuse(static_cast<int>(reader.find("hand", "manoeuvre")->source().begin.line),
                  "[hand] manoeuvre = 'poses' needs [hand] poses, a CSV file");
  }
}

void validateWhole(const TomlReader& reader, const Scenario& scene) {
  const std::span<const ScenarioKey> keys = scenarioKeys();
  reader.check(keys, "soil", [&] { validate(scene.bed.soil); });
  reader.check(keys, "bed", [&] { validate(scene.bed); });
  reader.check(keys, "tool", [&] { validate(scene.tool); });
  reader.check(keys, "hand", [&] { validate(scene.hand); });
  reader.check(keys, "loop", [&] { validate(scene.loop); });
  reader.check(keys, "mapping", [&] { validate(scene.handling.mapping); });
  reader.check(keys, "coupling", [&] { validate(scene.handling.coupling, scene.loop.tick_s); });
  reader.check(keys, "safety", [&] { validate(scene.handling.safety); });
  reader.check(keys, "", [&] { validate(scene); });
}

/// Where a scene's text comes from: recordings and studies hold what earlier versions have written.
enum class From { kFile, kStored };

/// A scene comes from anybody, and a library is code: only the command line and the environment name one. Recordings
/// and studies of earlier versions may hold the key; it has no meaning any more.
constexpr KeyName kLibrary{"device", "library"};

void refuseLibrary(const TomlReader& reader) {
  if (reader.find(kLibrary.table, kLibrary.name) != nullptr) {
    reader.refuseKey(kLibrary,
                     "left out: no file names code that is loaded; name the library on the command line "
                     "(--device-library PATH) or in the environment (FORCEDIM_SDK)");
  }
}

Scenario read(const TomlReader& reader, From from) {
  std::vector<KeyName> known = keyNames(scenarioKeys());
  known.push_back(kLibrary);
  reader.refuseUnknownKeys(known);
  if (from == From::kFile) {
    refuseLibrary(reader);
  }
  refuseContradictions(reader);
  Scenario scene;
  for (const ScenarioKey& key : scenarioKeys()) {
    reader.apply(key, scene);
  }
  requirePoses(reader, scene);
  validateWhole(reader, scene);
  return scene;
}

}  // namespace

Scenario loadScenario(const std::filesystem::path& path) {
  return read(TomlReader(path, kScene), From::kFile);
}

Scenario loadScenarioText(std::string_view text, std::string_view name) {
  return read(TomlReader(name, text, kScene), From::kStored);
}

}  // namespace haptolith
