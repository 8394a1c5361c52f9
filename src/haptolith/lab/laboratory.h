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

/// Callback for the progress of a test: current activity, and its completed fraction, 0 to 1. Returns false to cancel.
using LabProgress = std::function<bool(std::string_view what, double share)>;

class ShearMemory;

/// Conditions common to all tests of the laboratory.
struct LabConditions {
  SoilParameters soil;
  double gravity_m_s2 = 1.625;
  std::uint64_t seed = 1;  ///< seed of the specimen's initial particle positions
  int threads = 1;
  LabProgress progress{};
  ShearMemory* shear_memory = nullptr;  ///< results that several tests share; null: none. Outlives them
};

/// Time series of a test, one row per sample; column names carry units.
struct LabTrace {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
};

/// Verdict on a number: whether it meets its target; kInfo without a target.
enum class Verdict { kPass, kFail, kInfo };

/// One result of a test, compared with its target.
struct Finding {
  std::string measured;             ///< description of the quantity
  std::string target;               ///< target with its source; may be empty
  double number = 0;                ///< value in `unit`; NaN: no value
  std::string unit;                 ///< suffix of the number: "°", " Pa"; may be empty
  int decimals = 0;                 ///< number of decimals to display
  std::optional<Range> accepted{};  ///< range that passes; none: no verdict
};

}  // namespace haptolith
