#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "haptolith/identify/training/digging.h"
#include "haptolith/identify/training/training.h"
#include "haptolith/tool/tool_parameters.h"

#include "shared/overwrite.h"

namespace CLI {
class App;
}

namespace haptolith {

/// Options for a movement of a tool in a field.
struct MovementOptions {
  std::string poses_file;  ///< empty: the probe
  std::string scene_file;  ///< empty: the icra2021 shovel on the Moon
  std::vector<std::string> overrides;

  void addTo(CLI::App& command);
};

/// Digging given by the options.
struct Dig {
  ToolMovement movement;
  ToolParameters tool;
  DiggingField field;
};

/// @throws InvalidParameter, Failure: as findSceneFile(), PoseFile::read() and probeMovement().
[[nodiscard]] Dig digFor(const MovementOptions& options);

/// Options for digging in several soils; each result is saved to a file as soon as it is done.
struct SoilsOptions {
  MovementOptions movement;
  std::string out_file;
  int soils = 0;
  int threads = 0;  ///< 0: one per processor
  bool resume = false;
  Overwrite overwrite;

  /// @param usually  default number of soils.
  void addTo(CLI::App& command, int usually);
};

/// Digs in the soils that the file does not contain yet. @throws as trainingRun(); Failure when interrupted.
/// @param number_of  returns the number of the soil at a place, from 1.
[[nodiscard]] Training dugSoils(const SoilsOptions& options, std::uint64_t (*number_of)(std::uint64_t place));

/// Rewrites the file's runs. @throws Failure.
void keep(const SoilsOptions& options, const Training& training);

/// Returns "box, 50 mm by 40 mm by 5 mm".
[[nodiscard]] std::string textOf(const ToolParameters& tool);

}  // namespace haptolith
