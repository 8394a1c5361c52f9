#include <algorithm>
#include <filesystem>
#include <functional>
#include <utility>

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

/// The lines of keys, each table under its heading.
class Lines {
 public:
  /// @param heading  of a table; empty: its keys stand where they are
  explicit Lines(std::function<std::string(std::string_view table)> heading) : heading_(std::move(heading)) {}

  void add(std::string_view table, const std::string& line) {
    if (!line.empty() && table != table_) {
      table_ = table;
      text_ += heading_(table);
    }
    text_ += line;
  }
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  std::function<std::string(std::string_view)> heading_;
  std::string table_, text_;
};

/// One of [[tools]], the first of `scene`.
std::string toolText(const SceneFile& scene, bool for_people) {
  Lines lines([](std::string_view table) { return table == "tool" ? "" : fmt::format("\n[tools.{}]\n", table); });
  for (const SceneFileKey& key : keysOfTools()) {
    if (!for_people || counts(key, scene)) {
      lines.add(key.table, tomlLine(key, scene));
    }
  }
  return fmt::format("\n[[tools]]\nname = {}\n", tomlText(scene.tool_name)) + lines.text();
}

/// @param grains_file  replaces the given particles themselves in a file for people, which leaves out keys without
/// effect.
std::string textOf(const SceneFile& scene, std::string_view grains_file = {}) {
  const bool for_people = !grains_file.empty();
  const bool is_list = !scene.more_tools.empty() || scene.tool_name != SceneFile::kFirstToolName;
  Lines lines([](std::string_view table) { return fmt::format("\n[{}]\n", table); });
  for (const SceneFileKey& key : sceneFileKeys()) {
    if ((for_people && !counts(key, scene)) || (is_list && isOfTool(key))) {
      continue;
    }
    const bool is_grains = key.table == "bed" && key.name == "grains_data";
    lines.add(key.table,
              is_grains && for_people ? fmt::format("grains = {}\n", tomlText(grains_file)) : tomlLine(key, scene));
  }
  std::string text = lines.text() + placedStonesText(scene);
  if (is_list) {
    SceneFile each = scene;
    for (std::size_t i = 0; i < toolCount(scene); ++i) {
      exchangeFirst(each, i);
      text += toolText(each, for_people);
      exchangeFirst(each, i);
    }
  }
  return text;
}

/// The scene that reading its text gives: equal except for the folder of poses, and without a library.
SceneFile readBack(SceneFile scene) {
  for (std::size_t i = 0; i < toolCount(scene); ++i) {
    exchangeFirst(scene, i);
    std::string& poses = scene.hand.poses_file;
    poses = scene.hand.motion == HandMotion::kPoses ? std::filesystem::absolute(poses).string() : "";
    scene.device.library.clear();
    exchangeFirst(scene, i);
  }
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
