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

/// One specimen of a test as `haptolith lab TEST --json` prints it: what was done, from which seed, what came of it.
/// @param test  its name.
/// @param given  the test's own options, as the command line has them: key and text.
[[nodiscard]] nlohmann::ordered_json specimenJson(const std::string& test, const LabOptions& options,
                                                  const LabSoil& soil, const LabConditions& conditions,
                                                  const LabOutput& output,
                                                  const std::map<std::string, std::string>& given);

/// One that somebody's file holds.
struct Specimen {
  std::uint64_t seed = 0;
  nlohmann::ordered_json json;
  std::string file;  ///< empty: just measured

  /// All that its result depends on, but for the seed.
  [[nodiscard]] nlohmann::ordered_json conditions() const;
  /// What came of it.
  [[nodiscard]] nlohmann::ordered_json results() const;
  [[nodiscard]] std::vector<Finding> findings() const;
};

/// Reads what specimenJson() made and some program printed. @throws Failure for a file that holds anything else, with
/// the reason; InvalidParameter as openInput().
[[nodiscard]] Specimen readSpecimen(const std::string& path);

/// What specimens of one test have in common.
struct Collection {
  nlohmann::ordered_json json;
  std::string text;                       ///< a table
  std::vector<std::string> columns;       ///< of the rows: the seed, then each single number, at its place in the JSON
  std::vector<std::vector<double>> rows;  ///< of each specimen; NaN: none
};

/// Mean and scatter of each number over the specimens, in the order of their seeds.
/// @throws Failure for none, for two of one seed, and for those that were not made under the same conditions: says
/// which.
[[nodiscard]] Collection collected(std::vector<Specimen> specimens);

}  // namespace haptolith
