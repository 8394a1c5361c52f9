#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/identify/measured_movement.h"
#include "haptolith/identify/soil_belief.h"

namespace CLI {
class App;
}

namespace haptolith {

/// Options for the measurements of a movement or of its parts.
struct MeasuredOptions {
  std::vector<std::string> files;
  std::string training_file;  ///< empty: training of the probe
  std::vector<double> origin_mm{0, 0, 0};
  std::string body = "Moon";

  /// @param needed  whether a file is required.
  void addTo(CLI::App& command, bool needed);

  [[nodiscard]] Vec3 originM() const { return 1e-3 * Vec3(origin_mm[0], origin_mm[1], origin_mm[2]); }
};

/// Measurements given by the options.
struct Measured {
  SoilIdentifier identifier;
  std::vector<MovementPart> parts;  ///< parts of the training's movement
  MatchedParts matched;
  std::vector<double> first_s;  ///< time of each file's first row
  double gravity_m_s2;

  [[nodiscard]] std::vector<bool> partsMeasured() const;
  /// Lists the parts that were found, and their locations.
  [[nodiscard]] std::string text(const MeasuredOptions& options) const;
  [[nodiscard]] nlohmann::ordered_json json(const MeasuredOptions& options) const;
};

/// Reads the measurements. @throws as readTraining(), SoilIdentifier and readMeasured(); Failure if a file does not
/// contain any part of the movement.
[[nodiscard]] Measured measuredBy(const MeasuredOptions& options);

/// Adds --origin-mm, the centre of the soil's initial surface.
void addOrigin(CLI::App& command, std::vector<double>& origin_mm);

/// Writes a tool's poses, one per millisecond, as a file for `haptolith run --poses`. @throws as AtomicFile.
void writePoses(const OutputFile& file, const ToolMovement& movement, const Vec3& origin_m);

}  // namespace haptolith
