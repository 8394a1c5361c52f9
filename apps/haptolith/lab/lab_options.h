#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/lab/catalogue/lab_test.h"
#include "haptolith/lab/laboratory.h"

#include "shared/overwrite.h"

namespace CLI {
class App;
}

namespace haptolith {

/// Options common to all laboratory tests.
struct LabOptions {
  std::string soil = "lunar-0-15cm";
  std::optional<FrictionModel> friction;
  std::string body = "Moon";
  std::optional<double> radius_mm, stiffness_n_m;
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: one per processor
  bool json = false;
  std::string figure_file, trace_file;
  Overwrite overwrite;

  /// Adds the options to a command; a test without a figure or trace omits those.
  void addTo(CLI::App& command);
};

/// Returns --key-with-dashes.
[[nodiscard]] std::string flagOf(const LabOption& option);

/// Adds an option of a test under that name.
void addOption(CLI::App& command, const LabOption& option);

/// Returns the soil of the command line: a named one, a file, or a preset.
/// @param radius_mm  default radius of the particles; 0: the soil's radius.
[[nodiscard]] LabSoil labSoil(const LabOptions& options, double radius_mm);

/// Returns the number of threads for --threads; 0: one per processor.
[[nodiscard]] int threadsFor(int wanted);

[[nodiscard]] LabConditions labConditions(const LabOptions& options, const LabSoil& soil, LabProgress progress);

/// Returns the conditions that every test reports.
[[nodiscard]] nlohmann::ordered_json circumstancesJson(const LabOptions& options, const LabSoil& soil,
                                                       const LabConditions& conditions);
[[nodiscard]] std::string circumstancesText(const LabOptions& options, const LabSoil& soil,
                                            const LabConditions& conditions);

/// Returns the soil's keys, as in a soil file, without the friction model.
[[nodiscard]] nlohmann::ordered_json soilJson(const SoilParameters& soil);

/// Returns the measured values of the real soil; null without any.
[[nodiscard]] nlohmann::ordered_json targetJson(const std::optional<SoilTarget>& target);

/// Checks before hours of work that all files with a path can be written.
/// @throws Failure with the path and the system's reason.
void requireWritable(const std::vector<OutputFile>& files);

/// Writes a trace as CSV, atomically.
void saveTrace(const OutputFile& file, const LabTrace& trace);

}  // namespace haptolith
