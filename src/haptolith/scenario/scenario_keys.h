#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/scenario/scenario.h"

namespace haptolith {

// What a key's value is, which values are valid, and what it changes in the scene. A set() may throw InvalidParameter.

struct NumberValue {
  Range valid;  ///< in the unit of the key's name
  void (*set)(Scenario&, double);
};

struct CountValue {
  Range valid;
  void (*set)(Scenario&, std::int64_t);
};

struct VectorValue {
  Range valid;  ///< of each of the three numbers
  void (*set)(Scenario&, const Vec3&);
};

struct SwitchValue {
  void (*set)(Scenario&, bool);
};

struct WordValue {
  std::vector<std::string_view> valid;
  void (*set)(Scenario&, std::string_view);
};

struct TextValue {
  void (*set)(Scenario&, std::string_view);
};

/// One key of a scene file.
struct ScenarioKey {
  std::string_view table;  ///< "soil"; empty at the top of the file
  std::string_view name;
  std::string_view parameter;  ///< what validate() calls it, in SI: "width_m" for width_mm
  std::variant<NumberValue, CountValue, VectorValue, SwitchValue, WordValue, TextValue> value;
  std::string_view meaning;  ///< one sentence for docs/scenarios.md
};

/// Every key there is, in the order in which they are applied: what a key builds on stands before it.
[[nodiscard]] std::span<const ScenarioKey> scenarioKeys();

/// For example "14 to 1e+05", "three numbers, each > 0", "count, packed or rain", "true or false".
[[nodiscard]] std::string validText(const ScenarioKey& key);

}  // namespace haptolith
