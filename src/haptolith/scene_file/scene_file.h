#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/device/device_parameters.h"
#include "haptolith/device/hand/hand_parameters.h"
#include "haptolith/haptics/loop/handling_parameters.h"
#include "haptolith/haptics/loop_parameters.h"
#include "haptolith/scene/scene.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/tool/tool_mesh.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// Initial handling of a device in a person's hand: as high above the surface as the virtual hand.
[[nodiscard]] inline HandlingParameters handlingAboveTheBed() {
  HandlingParameters handling;
  handling.mapping.offset_m = HandParameters().home_m;
  return handling;
}

/// One of several tools in a scene, and what moves it.
struct SceneTool {
  std::string name;  ///< unique in its scene
  ToolMeshSource mesh;
  ToolParameters tool;
  HandParameters hand;
  DeviceParameters device;
  HandlingParameters handling = handlingAboveTheBed();

  [[nodiscard]] bool operator==(const SceneTool&) const = default;
};

/// A whole scene: soil in a box, tools, hands and the loop that joins them. The default is the scene icra2021.
struct SceneFile {
  std::string title = "The scene of the ICRA 2021 paper";
  std::string preset = "P3";  ///< empty when the soil has a name or was given by its numbers
  std::string soil_name;      ///< empty when the soil is a preset or was given by its numbers
  std::string body = "Moon";  ///< empty when gravity was given by its number
  BedParameters bed;
  ToolMeshSource mesh;  ///< source of the tool's mesh: see makeToolMesh()
  ToolParameters tool;
  HandParameters hand;
  LoopParameters loop;
  DeviceParameters device;
  HandlingParameters handling = handlingAboveTheBed();  ///< its offset is above the surface; not for the virtual hand
  std::string tool_name = std::string(kFirstToolName);
  std::vector<SceneTool> more_tools;  ///< after the first, whose mesh, tool, hand, device and handling are above

  static constexpr std::string_view kFirstToolName = "tool";  ///< name of a single tool
  static constexpr std::size_t kMostDevices = 4;              ///< devices in a loop

  [[nodiscard]] bool operator==(const SceneFile&) const = default;
};

[[nodiscard]] inline std::size_t toolCount(const SceneFile& scene_file) noexcept {
  return 1 + scene_file.more_tools.size();
}

/// The names of its tools, in order.
[[nodiscard]] std::vector<std::string_view> toolNames(const SceneFile& scene_file);

/// The number of the tool with that name. @throws InvalidParameter with the valid names.
[[nodiscard]] std::size_t toolNumber(const SceneFile& scene_file, std::string_view name);

/// @throws InvalidParameter for a name that a tool cannot have.
void requireToolName(std::string_view name);

/// Refuses a scene with several tools, for what moves or examines only one. @throws InvalidParameter.
void requireOneTool(const SceneFile& scene_file, std::string_view what);

/// Parameters of all tools, in order.
[[nodiscard]] ToolSet toolSet(const SceneFile& scene_file);

/// Makes a tool the first, and the first that one; a second call undoes it.
void exchangeFirst(SceneFile& scene_file, std::size_t tool);

/// Reads a TOML scene; keys that are left out keep the values of the scene icra2021. docs/reference/scenes.md lists
/// every key.
/// @throws InvalidParameter for an unknown key, a wrong type or a value out of range, with file, line, key, value and
/// valid range; Failure when the file cannot be read.
[[nodiscard]] SceneFile loadSceneFile(const std::filesystem::path& path);

/// The built-in scene of that name (a file of scenes/, without .toml), otherwise the file of that name.
/// @throws InvalidParameter listing the names when it is neither; otherwise as loadSceneFile().
/// @param overrides  keys that replace those of the file, each "table.key=value": see TomlReader::takeOverrides().
[[nodiscard]] SceneFile findSceneFile(std::string_view name_or_file, std::span<const std::string> overrides = {});

/// As above for a text, called `name` in messages, with files relative to that name; empty: the scene icra2021.
[[nodiscard]] SceneFile sceneFileFromText(std::string_view text, std::string_view name,
                                          std::span<const std::string> overrides = {});

/// The scene with some of its keys changed; soil that it is given by name or preset keeps the size of its grains unless
/// soil.radius_mm says otherwise. @throws InvalidParameter as loadSceneFile().
[[nodiscard]] SceneFile changed(const SceneFile& scene_file, std::span<const std::string> overrides);

/// The built-in scenes: the files in scenes/.
[[nodiscard]] std::vector<std::string> sceneNames();

/// Which keys the scene of that name or in that file sets, to other than the usual value, without any effect in
/// `scene`, which may be another by now: a line for each with file, key and what the key needs. Keys that could never
/// have an effect are errors already when the scene is loaded. @throws as findSceneFile().
[[nodiscard]] std::vector<std::string> idleKeys(std::string_view name_or_file, const SceneFile& scene,
                                                std::span<const std::string> overrides = {});

/// As loadSceneFile() for a stored text, called `name`, with files relative to that name; a device's library is
/// ignored.
[[nodiscard]] SceneFile loadSceneFileText(std::string_view text, std::string_view name);

/// The complete scene as TOML, for recordings: loadSceneFileText() restores a bit-identical scene in any working
/// folder and with any later presets, named soils and bodies. Soil and gravity are written by
/// their numbers, their names for information; poses by their absolute path, if the hand follows them; no library.
/// @throws InvalidParameter for a scene that no file can hold: a value out of its key's range, one of those that only
/// the laboratory sets (a periodic box, another tick), a length that is not a number of mm, a file of poses that has
/// gone.
[[nodiscard]] std::string sceneFileText(const SceneFile& scene_file);

/// The scene as a file for people, with its particles in a CSV file next to it (given_grains.h), whatever their
/// origin.
[[nodiscard]] std::string sceneFileTextWithGrains(SceneFile scene_file, std::string_view grains_file);

/// Handling above soil with this surface height: the virtual hand's frame is the scene's, another
/// device's workspace is above the surface.
[[nodiscard]] HandlingParameters handlingOf(const SceneFile& scene_file, double surface_m);

/// As above for the caller's device, whichever the scene names.
[[nodiscard]] HandlingParameters handlingOfOwnDevice(const SceneFile& scene_file, double surface_m);

/// Puts a named soil into the scene, its macroparticles as large as its file has them.
void setSoil(SceneFile& scene_file, const SoilFile& soil);

/// Puts a preset or a soil with a name (or in a file) into the scene, its macroparticles as large as the scene's were.
/// @throws InvalidParameter, Failure: as findPreset() and findSoil().
void changePreset(SceneFile& scene_file, std::string_view name);
void changeSoil(SceneFile& scene_file, std::string_view name_or_file);

/// Takes the scene to another world; gravity keeps its direction. @throws InvalidParameter as findBody().
void changeBody(SceneFile& scene_file, std::string_view name);

/// Soil, world, size of grains, tool and motion: "surveyor-3 soil, Mars, R = 3.5 mm, shovel, scoop".
[[nodiscard]] std::string sceneInWords(const SceneFile& scene_file);

/// Replaces the title by sceneInWords() where that differs from `before`, sceneInWords() before a change: the title may
/// name what has changed. changePreset(), changeSoil() and changeBody() have done it.
void retitle(SceneFile& scene_file, std::string_view before);

/// Whether makeCoarser() has coarser particles for the scene: its bed starts as settled, with particles of one size,
/// and its box has room for larger ones.
[[nodiscard]] bool canBeCoarser(const SceneFile& scene_file);

/// Gives the scene particles that are one step coarser (coarserRadius()). @throws InvalidParameter unless
/// canBeCoarser(); as makeToolMesh().
void makeCoarser(SceneFile& scene_file);

/// Makes the tool's mesh of what the scene says of it, for its soil; to be called whenever either has changed.
/// @throws InvalidParameter, Failure: as toolMesh().
void makeToolMesh(SceneFile& scene_file);

/// Checks relations between keys: for example that the bed, the tool and the hand fit into one scene.
/// @throws InvalidParameter.
void validate(const SceneFile& scene_file);

}  // namespace haptolith
