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

/// Which device holds the tool, as the command line says it.
struct DeviceOptions {
  std::optional<DeviceKind> kind;
  std::optional<std::string> id, library, address, key_file;
  bool insecure = false;

  /// @return the option that names the device.
  CLI::Option* addTo(CLI::App& command);
  /// @throws InvalidParameter, Failure when a key that it wants cannot be read.
  void applyTo(DeviceParameters& device) const;
};

/// Which scene, as the command line says it; everything else comes from the scene file.
struct SceneOptions {
  std::string name_or_file;
  std::string usual = "regolith";      ///< what opens when no scene is named
  std::vector<std::string> overrides;  ///< keys of the scene file, each "table.key=value"
  std::optional<std::string> preset, soil, body, poses_file;
  std::optional<FrictionModel> friction;
  std::optional<Manoeuvre> manoeuvre;
  std::optional<int> threads;
  std::optional<std::uint64_t> seed;
  DeviceOptions device;

  void addTo(CLI::App& command);
  /// Name or file of the scene that opens: the paper's soils are made for its scene.
  [[nodiscard]] std::string scene() const;
};

/// The scene that the options ask for, with a warning for each key of its file that has no effect; not yet checked by
/// validate(), since a command may still change it.
/// @throws InvalidParameter, Failure: as findSceneFile(), changePreset(), changeSoil() and changeBody().
[[nodiscard]] SceneFile sceneFileFor(const SceneOptions& options);

/// Shows in `status` how the bed of a new scene settles; a signal ends it.
[[nodiscard]] SettleProgress settlingIn(StatusLine& status);

}  // namespace haptolith
