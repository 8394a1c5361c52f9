#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/scene_file/scene_file.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace haptolith {

class StatusLine;

/// Options for the device that holds the tool.
struct DeviceOptions {
  std::optional<DeviceKind> kind;
  std::optional<std::string> id, library, address, key_file;
  bool insecure = false;

  /// Adds the options. @return the option that names the device.
  /// @param of_tools  also takes devices for tools by their names; null: the scene has one tool.
  CLI::Option* addTo(CLI::App& command, std::vector<std::string>* of_tools = nullptr);
  /// Applies the options. @throws InvalidParameter, Failure if a required key cannot be read.
  void applyTo(DeviceParameters& device) const;
};

/// Options for the scene; everything else comes from the scene file.
struct SceneOptions {
  std::string name_or_file;
  std::string usual = "regolith";      ///< default scene
  std::vector<std::string> overrides;  ///< overrides of scene keys, each "table.key=value"
  std::optional<std::string> preset, soil, body, poses_file;
  std::optional<FrictionModel> friction;
  std::optional<HandMotion> motion;
  std::optional<int> threads;
  std::optional<std::uint64_t> seed;
  DeviceOptions device;
  std::vector<std::string> devices;  ///< each "KIND", or "TOOL=KIND[:WHICH]"

  void addTo(CLI::App& command);
  /// Returns the name or file of the scene; the icra2021 soils require the icra2021 scene.
  [[nodiscard]] std::string scene() const;
};

/// Returns the scene of the options, with a warning for each key of its file without effect. It is not yet checked by
/// validate(), because a command may still change it.
/// @throws InvalidParameter, Failure: as findSceneFile(), changePreset(), changeSoil() and changeBody().
[[nodiscard]] SceneFile sceneFileFor(const SceneOptions& options);

/// Shows the progress of settling a new scene in `status`; a signal ends it.
[[nodiscard]] SettleProgress settlingIn(StatusLine& status);

}  // namespace haptolith
