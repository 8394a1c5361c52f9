#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/soil/soil_parameters.h"
#include "haptolith/soil/soil_target.h"

namespace haptolith {

/// A soil with a name: its measured strength, and macroparticles that behave like it. See docs/reference/soils.md.
struct SoilFile {
  std::string name;
  std::string source;  ///< source of the target; may be empty
  SoilTarget target;
  SoilParameters soil;
  std::optional<SoilReached> reached;  ///< none: not calibrated
};

/// @throws InvalidParameter with file, line, key, value and valid range; Failure when the file cannot be read.
[[nodiscard]] SoilFile loadSoilFile(const std::filesystem::path& path);

/// As loadSoilFile() for a text, called `name` in messages.
[[nodiscard]] SoilFile soilFileFromText(std::string_view text, std::string_view name);
/// Text that saveSoilFile() writes. @throws InvalidParameter as it.
[[nodiscard]] std::string soilFileText(const SoilFile& soil);

/// The built-in soil of that name, upper and lower case alike; otherwise the file of that name.
/// @throws InvalidParameter listing the built-in names when it is neither; otherwise as loadSoilFile().
[[nodiscard]] SoilFile findSoil(std::string_view name_or_file);

/// A soil under its name, wherever it comes from.
struct NamedSoil {
  std::string name;
  SoilParameters soil;
  std::optional<SoilFile> file;  ///< none: one of the paper's presets, of which nothing was measured
};

/// One of the paper's presets (P1 to P6), otherwise as findSoil(). @throws as findSoil().
[[nodiscard]] NamedSoil findSoilOrPreset(std::string_view name_or_file);

/// The built-in soils: the files in soils/.
[[nodiscard]] std::vector<std::string> soilNames();

/// Writes the file, completely or not at all; loadSoilFile() restores bit-identical numbers (a radius that is not
/// exact in mm may differ in the last bit).
/// @throws InvalidParameter for what loadSoilFile() would refuse; Failure when it is there or cannot be written.
void saveSoilFile(const std::filesystem::path& path, const SoilFile& soil);

}  // namespace haptolith
