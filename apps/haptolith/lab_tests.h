#pragma once

#include <nlohmann/json.hpp>

#include <functional>
#include <string>
#include <vector>

#include "haptolith/lab/report_page.h"

#include "lab_options.h"

namespace haptolith {

/// One number a test came for, beside what it should be.
struct LabFinding {
  std::string measured;  ///< what, in words
  std::string target;    ///< with its source; may be empty
  std::string value;     ///< with its unit
  Verdict verdict = Verdict::kInfo;
};

/// What a test has to say when it is done.
struct LabOutput {
  nlohmann::ordered_json json;
  std::string text;  ///< a table
  LabTrace trace;
  std::vector<LabFinding> findings;
  std::function<void(const OutputFile& file, const std::string& title)> draw;
};

/// A test of the laboratory as the command line knows it.
struct LabTest {
  std::string name, description, examples;
  double radius_mm = 0;           ///< of the macroparticles unless --radius-mm says otherwise; 0: as in the soil's file
  bool without_cohesion = false;  ///< the report does it with the soil's cohesion taken away
  std::function<void(CLI::App&)> add_options;
  std::function<LabOutput(const LabSoil&, const LabConditions&)> run;
};

/// All tests, in the order of the report, each with options of its own.
[[nodiscard]] std::vector<LabTest> labTests();

}  // namespace haptolith
