#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/plain_text.h"
#include "haptolith/scene_file/toml/file_keys.h"

namespace haptolith {

/// A word of scene files, soil files and the command line, and its value.
template <class Value>
struct SceneWord {
  std::string_view name;
  Value value;
};

template <class Value>
SceneWord(const char*, Value) -> SceneWord<Value>;  // clang 14 does not deduce it

/// The names in a table of words, presets or bodies.
template <class Table>
[[nodiscard]] std::vector<std::string_view> namesOf(const Table& table) {
  std::vector<std::string_view> names;
  names.reserve(table.size());
  for (const auto& entry : table) {
    names.push_back(entry.name);
  }
  return names;
}

/// The value of a word. @throws InvalidParameter when it is not in `table`.
template <class Table>
[[nodiscard]] auto valueOf(const Table& table, std::string_view name) {
  const auto entry = std::ranges::find(table, name, [](const auto& word) { return word.name; });
  if (entry == table.end()) {
    throw InvalidParameter("word", inQuotes(std::string(name)), anyOf(namesOf(table)));
  }
  return entry->value;
}

/// The word for a value. @throws InvalidParameter for one that has none: shapes that only the laboratory uses.
template <class Table, class Value>
[[nodiscard]] std::string_view wordFor(const Table& table, Value value) {
  const auto entry = std::ranges::find(table, value, [](const auto& word) { return word.value; });
  if (entry == table.end()) {
    throw InvalidParameter("value", std::to_string(static_cast<int>(value)), "one of " + anyOf(namesOf(table)));
  }
  return entry->name;
}

}  // namespace haptolith
