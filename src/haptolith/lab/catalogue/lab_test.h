#pragma once

#include <nlohmann/json.hpp>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/lab/catalogue/lab_option.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/soil/soil_target.h"

namespace haptolith {

/// A soil under its name.
struct LabSoil {
  std::string name;
  SoilParameters soil;
  std::optional<SoilTarget> target;  ///< none for a preset
};

/// In what the soil of a test is to be different.
struct SoilChanges {
  std::optional<double> radius_mm = {};  ///< of the macroparticles; 0.1 to 100
  std::optional<double> stiffness_n_m = {};
  std::optional<FrictionModel> friction = {};
};

/// What a test has to say when it is done.
struct LabOutput {
  nlohmann::ordered_json json;
  std::string text;  ///< a table
  LabTrace trace;
  std::vector<Finding> findings;
  std::function<void(const OutputFile& file, const std::string& title)> draw;
};

/// A test of the laboratory as the command line and the library offer it, with options of its own: another one has
/// others.
struct LabTest {
  std::string name, description, examples;
  double radius_mm = 0;           ///< of the macroparticles unless somebody says otherwise; 0: as in the soil's file
  bool without_cohesion = false;  ///< the report does it with the soil's cohesion taken away
  bool in_report = true;          ///< whether the report does it
  double typical_s = 1;           ///< about how long it takes on one thread with the usual options: an estimate
  std::vector<LabOption> options;
  std::function<LabOutput(const LabSoil&, const LabConditions&)> run;
};

/// The soil as a test takes it that has macroparticles of `radius_mm` (0: the soil's own) unless the changes say
/// otherwise. The soil stays the same; its macroparticles do not. @throws InvalidParameter for a radius out of range.
[[nodiscard]] SoilParameters soilForTest(SoilParameters soil, double radius_mm, const SoilChanges& changes);

/// All tests, in the order of the report, with their usual options.
[[nodiscard]] std::vector<LabTest> labTests();

/// One of them. @throws InvalidParameter with the names there are.
[[nodiscard]] LabTest labTest(std::string_view name);

}  // namespace haptolith
