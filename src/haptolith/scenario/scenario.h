#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/device/hand_parameters.h"
#include "haptolith/haptics/loop_parameters.h"
#include "haptolith/scenario/soil_file.h"
#include "haptolith/tool/tool_parameters.h"

namespace haptolith {

/// A whole scene: soil in a box, a tool, a hand and the loop that joins them. The default is the paper's scene.
struct Scenario {
  std::string title = "The paper's scene";
  std::string preset = "P3";  ///< empty when the soil has a name of its own or was given by its numbers
  std::string soil_name;      ///< empty when the soil is a preset or was given by its numbers
  std::string body = "Moon";  ///< empty when gravity was given by its number
  BedParameters bed;
  ToolParameters tool;
  HandParameters hand;
  LoopParameters loop;
};

/// Reads a TOML scene; keys that are left out keep the values of the paper's scene. docs/scenarios.md lists every key.
/// @throws InvalidParameter for an unknown key, a wrong type or a value out of range, with file, line, key, value and
/// valid range; Failure when the file cannot be read.
[[nodiscard]] Scenario loadScenario(const std::filesystem::path& path);

/// Puts a named soil into the scene, its macroparticles as large as its file has them.
void setSoil(Scenario& scenario, const SoilFile& soil);

/// Puts a preset or a soil with a name (or in a file) into the scene, its macroparticles as large as the scene's were.
/// @throws InvalidParameter, Failure: as findPreset() and findSoil().
void changePreset(Scenario& scenario, std::string_view name);
void changeSoil(Scenario& scenario, std::string_view name_or_file);

/// Takes the scene to another world; gravity keeps its direction. @throws InvalidParameter as findBody().
void changeBody(Scenario& scenario, std::string_view name);

/// Checks what no single key can tell: for example that the bed, the tool and the hand fit into one scene.
/// @throws InvalidParameter.
void validate(const Scenario& scenario);

}  // namespace haptolith
