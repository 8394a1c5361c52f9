#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// Which strength of a sheared bed is compared with the target.
enum class SoilStrength {
  kResidual,  ///< what is left after long shearing
  kPeak,      ///< the most it carries
};

/// What an engineer measured.
struct SoilTarget {
  double bulk_density_kg_m3 = 0;
  double friction_angle_deg = 0;
  std::optional<Range> friction_angle_range_deg;  ///< the measurement's own uncertainty, where it is known
  double cohesion_pa = 0;
  std::optional<Range> cohesion_range_pa;
  SoilStrength strength = SoilStrength::kResidual;
};

/// What the virtual laboratory measured of the macroparticles in the end: mean and standard deviation over seeds.
struct SoilReached {
  double friction_angle_deg = 0, friction_angle_sd_deg = 0;
  double cohesion_pa = 0, cohesion_sd_pa = 0;
  double bulk_density_kg_m3 = 0;
  int seeds = 0;
};

/// A soil with a name: its measured strength, and macroparticles that behave like it. See docs/soils.md.
struct SoilFile {
  std::string name;
  std::string source;  ///< where the target comes from; may be empty
  SoilTarget target;
  SoilParameters soil;
  std::optional<SoilReached> reached;  ///< none: not calibrated
};

/// @throws InvalidParameter with file, line, key, value and valid range; Failure when the file cannot be read.
[[nodiscard]] SoilFile loadSoilFile(const std::filesystem::path& path);

/// The built-in soil of that name, upper and lower case alike; otherwise the file of that name.
/// @throws InvalidParameter listing the built-in names when it is neither; otherwise as loadSoilFile().
[[nodiscard]] SoilFile findSoil(std::string_view name_or_file);

/// The built-in soils: the files in soils/.
[[nodiscard]] std::vector<std::string> soilNames();

/// Writes the file, whole or not at all; loadSoilFile() gives the same numbers, to the last bit (a radius that is no
/// number of mm may lose it).
/// @throws InvalidParameter for what loadSoilFile() would refuse; Failure when the file cannot be written.
void saveSoilFile(const std::filesystem::path& path, const SoilFile& soil);

}  // namespace haptolith
