#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// Told now and then what a test is doing and how much of that is done, 0 to 1; false gives up.
using LabProgress = std::function<bool(std::string_view what, double share)>;

/// What is tested, and where. Common to all tests of the laboratory.
struct LabConditions {
  SoilParameters soil;
  double gravity_m_s2 = 1.625;
  std::uint64_t seed = 1;  ///< of the specimen: where its particles fell
  int threads = 1;
  LabProgress progress{};
};

/// What was measured while a test ran, one row a moment; column names carry units.
struct LabTrace {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
};

/// Whether a number meets its target; kInfo where there is no target for it.
enum class Verdict { kPass, kFail, kInfo };

/// One number a test came for, beside what it should be.
struct Finding {
  std::string measured;             ///< what, in words
  std::string target;               ///< with its source; may be empty
  double number = 0;                ///< in `unit`; NaN: there is none
  std::string unit;                 ///< as it stands behind the number: "°", " Pa"; may be empty
  int decimals = 0;                 ///< to be shown
  std::optional<Range> accepted{};  ///< where it passes; none: there is nothing to pass or fail
};

}  // namespace haptolith
