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

/// Soil with its name.
struct LabSoil {
  std::string name;
  SoilParameters soil;
  std::optional<SoilTarget> target;  ///< empty for a preset
};

/// Changes to the soil of a test.
struct SoilChanges {
  std::optional<double> radius_mm = {};  ///< radius of the particles; 0.1 to 100
  std::optional<double> stiffness_n_m = {};
  std::optional<FrictionModel> friction = {};
};

/// Output of a test.
struct LabOutput {
  nlohmann::ordered_json json;
  std::string text;  ///< table
  LabTrace trace;
  std::vector<Finding> findings;
  std::function<void(const OutputFile& file, const std::string& title)> draw;
};

/// Test of the laboratory for the command line and the library, with its options.
struct LabTest {
  std::string name, description, examples;
  double radius_mm = 0;           ///< default radius of the particles; 0: as in the soil's file
  bool without_cohesion = false;  ///< whether the report removes the soil's cohesion for this test
  bool in_report = true;          ///< whether it is part of the report
  double typical_s = 1;           ///< estimated duration on one thread with the default options
  std::vector<LabOption> options;
  std::function<LabOutput(const LabSoil&, const LabConditions&)> run;
};

/// Returns the soil for a test with particles of `radius_mm` (0: the soil's radius) unless the changes set another
/// radius. The soil stays the same; its particles do not. @throws InvalidParameter for a radius out of range.
[[nodiscard]] SoilParameters soilForTest(SoilParameters soil, double radius_mm, const SoilChanges& changes);

/// Returns all tests, in the order of the report, with their default options.
[[nodiscard]] std::vector<LabTest> labTests();

/// Returns the test of this name, or of its name in an earlier version. @throws InvalidParameter with the valid names.
[[nodiscard]] LabTest labTest(std::string_view name);

}  // namespace haptolith
