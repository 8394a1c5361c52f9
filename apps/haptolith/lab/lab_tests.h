#pragma once

#include <nlohmann/json.hpp>

#include <functional>
#include <string>
#include <vector>

#include "haptolith/lab/laboratory.h"

#include "lab/lab_options.h"

namespace haptolith {

/// What a test has to say when it is done.
struct LabOutput {
  nlohmann::ordered_json json;
  std::string text;  ///< a table
  LabTrace trace;
  std::vector<Finding> findings;
  std::function<void(const OutputFile& file, const std::string& title)> draw;
};

/// A test of the laboratory as the command line knows it.
struct LabTest {
  std::string name, description, examples;
  double radius_mm = 0;           ///< of the macroparticles unless --radius-mm says otherwise; 0: as in the soil's file
  bool without_cohesion = false;  ///< the report does it with the soil's cohesion taken away
  bool in_report = true;          ///< whether the report does it
  std::function<void(CLI::App&)> add_options;
  std::function<LabOutput(const LabSoil&, const LabConditions&)> run;
};

/// All tests, in the order of the report, each with options of its own.
[[nodiscard]] std::vector<LabTest> labTests();

}  // namespace haptolith
