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

/// A movement of a tool in a field, as the command line says it.
struct MovementOptions {
  std::string poses_file;  ///< empty: the probe
  std::string scene_file;  ///< empty: the paper's shovel on the Moon
  std::vector<std::string> overrides;

  void addTo(CLI::App& command);
};

/// What these options stand for.
struct Dig {
  ToolMovement movement;
  ToolParameters tool;
  DiggingField field;
};

/// @throws InvalidParameter, Failure: as findSceneFile(), PoseFile::read() and probeMovement().
[[nodiscard]] Dig digFor(const MovementOptions& options);

/// Soils that are dug in and kept in a file as soon as each is done.
struct SoilsOptions {
  MovementOptions movement;
  std::string out_file;
  int soils = 0;
  int threads = 0;  ///< 0: one for each processor
  bool resume = false;
  Overwrite overwrite;

  /// @param others  how many soils there are unless it is said.
  void addTo(CLI::App& command, int usually);
};

/// Digs in those soils that the file does not have yet. @throws as trainingRun(); Failure when somebody ends it.
/// @param number_of  the number of the first, the second, and so on, from 1.
[[nodiscard]] Training dugSoils(const SoilsOptions& options, std::uint64_t (*number_of)(std::uint64_t place));

/// The file's runs, written anew. @throws Failure.
void keep(const SoilsOptions& options, const Training& training);

/// "box, 50 mm by 40 mm by 5 mm"
[[nodiscard]] std::string textOf(const ToolParameters& tool);

}  // namespace haptolith
