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

/// What all tests of the laboratory can be told on the command line.
struct LabOptions {
  std::string soil = "lunar-0-15cm";
  std::optional<FrictionModel> friction;
  std::string body = "Moon";
  std::optional<double> radius_mm, stiffness_n_m;
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: as many as the machine has
  bool json = false;
  std::string figure_file, trace_file;
  Overwrite overwrite;

  /// The command's options; a test without a figure or trace leaves those out.
  void addTo(CLI::App& command);
};

/// --key-with-dashes.
[[nodiscard]] std::string flagOf(const LabOption& option);

/// An option of a test under that name.
void addOption(CLI::App& command, const LabOption& option);

/// The soil that the command line named: a named one, a file, or one of the paper's presets.
/// @param radius_mm  of the macroparticles when the options name none; 0 leaves them as the soil has them.
[[nodiscard]] LabSoil labSoil(const LabOptions& options, double radius_mm);

/// The number of threads for --threads; 0: one for each processor.
[[nodiscard]] int threadsFor(int wanted);

[[nodiscard]] LabConditions labConditions(const LabOptions& options, const LabSoil& soil, LabProgress progress);

/// What every test says about its circumstances.
[[nodiscard]] nlohmann::ordered_json circumstancesJson(const LabOptions& options, const LabSoil& soil,
                                                       const LabConditions& conditions);
[[nodiscard]] std::string circumstancesText(const LabOptions& options, const LabSoil& soil,
                                            const LabConditions& conditions);

/// The soil's keys, as a soil file has them, without the model of friction.
[[nodiscard]] nlohmann::ordered_json soilJson(const SoilParameters& soil);

/// What an engineer measured of the soil; null: nothing.
[[nodiscard]] nlohmann::ordered_json targetJson(const std::optional<SoilTarget>& target);

/// Hours of work must not end in a file that cannot be written: tries each whose path is not empty.
/// @throws Failure with the path and the system's reason.
void requireWritable(const std::vector<OutputFile>& files);

/// Writes a trace as CSV, whole or not at all.
void saveTrace(const OutputFile& file, const LabTrace& trace);

}  // namespace haptolith
