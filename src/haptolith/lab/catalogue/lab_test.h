#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "haptolith/core/atomic_file.h"
#include "haptolith/core/error.h"
#include "haptolith/lab/laboratory.h"
#include "haptolith/soil/soil_target.h"

namespace haptolith {

/// An option of a test, which whoever offers the test reads in his own way. What set() is told the test itself checks.
struct LabOption {
  using Number = std::function<void(double)>;
  using List = std::function<void(const std::vector<double>&)>;
  using Switch = std::function<void()>;  ///< given or not
  struct Count {
    Range valid;
    std::function<void(std::int64_t)> set;
  };
  struct Word {
    std::vector<std::string> words;
    std::function<void(std::string_view)> set;
  };

  std::string key;    ///< "depth_m"; on the command line --depth-m
  std::string help;   ///< without what is usual
  std::string usual;  ///< what holds when nobody sets it, as text; may be empty
  std::variant<Number, List, Switch, Count, Word> set;
};

/// A soil under its name.
struct LabSoil {
  std::string name;
  SoilParameters soil;
  std::optional<SoilTarget> target;  ///< none for a preset
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
  std::vector<LabOption> options;
  std::function<LabOutput(const LabSoil&, const LabConditions&)> run;
};

/// All tests, in the order of the report, with their usual options.
[[nodiscard]] std::vector<LabTest> labTests();

/// One of them. @throws InvalidParameter with the names there are.
[[nodiscard]] LabTest labTest(std::string_view name);

}  // namespace haptolith
