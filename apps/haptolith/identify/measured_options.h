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

/// What was measured while a movement, or parts of it, were made, as the command line says it.
struct MeasuredOptions {
  std::vector<std::string> files;
  std::string training_file;  ///< empty: the probe's
  std::vector<double> origin_mm{0, 0, 0};
  std::string body = "Moon";

  /// @param needed  whether there is nothing to do without a file.
  void addTo(CLI::App& command, bool needed);

  [[nodiscard]] Vec3 originM() const { return 1e-3 * Vec3(origin_mm[0], origin_mm[1], origin_mm[2]); }
};

/// What these options stand for.
struct Measured {
  SoilIdentifier identifier;
  std::vector<MovementPart> parts;  ///< of the movement that was learned
  MatchedParts matched;
  std::vector<double> first_s;  ///< time of each file's first row
  double gravity_m_s2;

  [[nodiscard]] std::vector<bool> partsMeasured() const;
  /// Which parts were found, and where.
  [[nodiscard]] std::string text(const MeasuredOptions& options) const;
  [[nodiscard]] nlohmann::ordered_json json(const MeasuredOptions& options) const;
};

/// @throws as readTraining(), SoilIdentifier and readMeasured(); Failure where a file has nothing of the movement.
[[nodiscard]] Measured measuredBy(const MeasuredOptions& options);

/// --origin-mm, where the middle of the soil's first surface is.
void addOrigin(CLI::App& command, std::vector<double>& origin_mm);

/// Writes where a tool goes, every millisecond, as `haptolith run --poses` takes it. @throws as AtomicFile.
void writePoses(const OutputFile& file, const ToolMovement& movement, const Vec3& origin_m);

}  // namespace haptolith
