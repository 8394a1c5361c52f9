#include <algorithm>
#include <filesystem>

#include "haptolith/scene_file/key_use.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/scene_file_keys.h"
#include "haptolith/scene_file/stone_keys.h"
#include "haptolith/scene_file/toml/toml_writer.h"

namespace haptolith {

namespace {

bool counts(const SceneFileKey& key, const SceneFile& scene) {
  return std::ranges::none_of(keyUses(), [&](const KeyUse& use) {
    return use.table == key.table && use.name == key.name && !use.counts(scene);
  });
}

/// @param grains_file  replaces the given particles themselves in a file for people, which leaves out keys without
/// effect.
std::string textOf(const SceneFile& scene, std::string_view grains_file = {}) {
  const bool for_people = !grains_file.empty();
  std::string text;
  std::string_view table;
  for (const SceneFileKey& key : sceneFileKeys()) {
    if (for_people && !counts(key, scene)) {
      continue;
    }
    const bool is_grains = key.table == "bed" && key.name == "grains_data";
    const std::string line =
        is_grains && for_people ? fmt::format("grains = {}\n", tomlText(grains_file)) : tomlLine(key, scene);
    if (!line.empty() && key.table != table) {
      table = key.table;
      text += fmt::format("\n[{}]\n", table);
    }
    text += line;
  }
  return text + placedStonesText(scene);
}

/// The scene that reading its text gives: equal except for the folder of poses, and without a library.
SceneFile readBack(SceneFile scene) {
  std::string& poses = scene.hand.poses_file;
  poses = scene.hand.motion == HandMotion::kPoses ? std::filesystem::absolute(poses).string() : "";
  scene.device.library.clear();
  return scene;
}

}  // namespace

std::string sceneFileTextWithGrains(SceneFile scene_file, std::string_view grains_file) {
  scene_file.bed.start = BedStart::kGiven;
  scene_file.bed.given = {};
  scene_file.bed.grading = {};
  return textOf(scene_file, grains_file);
}

std::string sceneFileText(const SceneFile& scene_file) {
  std::string text = textOf(scene_file);
  if (!(loadSceneFileText(text, "the scene as text") == readBack(scene_file))) {
    throw InvalidParameter("scenario", fmt::format("'{}'", scene_file.title),
                           "a scene that a scene file can describe: with a title, lengths in mm, walls on all sides, "
                           "the default tick, and default values where there is no key");
  }
  return text;
}

}  // namespace haptolith
