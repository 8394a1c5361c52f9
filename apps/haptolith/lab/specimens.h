#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "haptolith/lab/catalogue/lab_test.h"
#include "haptolith/lab/laboratory.h"

#include "lab/lab_options.h"

namespace haptolith {

/// Returns one specimen of a test as printed by `haptolith lab TEST --json`: conditions, seed and results.
/// @param test  name of the test.
/// @param given  the test's options on the command line: key and text.
[[nodiscard]] nlohmann::ordered_json specimenJson(const std::string& test, const LabOptions& options,
                                                  const LabSoil& soil, const LabConditions& conditions,
                                                  const LabOutput& output,
                                                  const std::map<std::string, std::string>& given);

/// Specimen, read from a file or just simulated.
struct Specimen {
  std::uint64_t seed = 0;
  nlohmann::ordered_json json;
  std::string file;  ///< empty: just simulated

  /// Returns all conditions of its results except the seed.
  [[nodiscard]] nlohmann::ordered_json conditions() const;
  /// Returns its results.
  [[nodiscard]] nlohmann::ordered_json results() const;
  [[nodiscard]] std::vector<Finding> findings() const;
};

/// Reads the output of specimenJson() from a file. @throws Failure for other content, with the reason; InvalidParameter
/// as openInput().
[[nodiscard]] Specimen readSpecimen(const std::string& path);

/// Statistics over specimens of one test.
struct Collection {
  nlohmann::ordered_json json;
  std::string text;                       ///< table
  std::vector<std::string> columns;       ///< names: the seed, then each number by its path in the JSON
  std::vector<std::vector<double>> rows;  ///< one per specimen; NaN: no value
};

/// Computes mean and SD of each number over the specimens, in the order of their seeds.
/// @throws Failure without specimens, for equal seeds, and for different conditions, which are listed.
[[nodiscard]] Collection collected(std::vector<Specimen> specimens);

}  // namespace haptolith
