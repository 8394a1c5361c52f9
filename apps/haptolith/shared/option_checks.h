#pragma once

#include <CLI/App.hpp>

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/former_names.h"
#include "haptolith/scene_file/toml/file_keys.h"

namespace haptolith {

// Validators of options. The error for an invalid value contains the value and the valid range: "--threads: 0 is not
// valid: must be a whole number, 1 to 256".

/// Accepts a finite number in `range`.
[[nodiscard]] CLI::Validator numberIn(const Range& range);

/// Accepts a whole number in `range`.
[[nodiscard]] CLI::Validator wholeNumberIn(const Range& range);

/// Accepts one of these words.
[[nodiscard]] CLI::Validator oneOf(const std::vector<std::string>& words);

/// Accepts the name of an output; not `-`, which other programs use for standard output.
[[nodiscard]] CLI::Validator outputName();

/// Returns the error for `word`: "'dig' is not valid: must be press or stir; did you mean ...?".
[[nodiscard]] std::string notAmong(const std::vector<std::string>& words, const std::string& word);

/// Converts a word of `table`, in upper or lower case, to its value; for transform().
template <class Value>
[[nodiscard]] CLI::Validator wordOf(const std::map<std::string, Value>& table) {
  std::vector<std::string> words;
  words.reserve(table.size());
  for (const auto& [word, value] : table) {
    words.push_back(word);
  }
  const auto read = [table, words](std::string& text) -> std::string {
    const auto entry = table.find(std::string(currentNameReported(NameKind::kWord, CLI::detail::to_lower(text))));
    if (entry == table.end()) {
      return notAmong(words, text);
    }
    text = std::to_string(static_cast<int>(entry->second));  // CLI11 parses an enumeration from its number
    return "";
  };
  return {read, CLI::detail::generate_set(words)};
}

/// Returns the program's message for an error of CLI11; `reached` is the selected command.
[[nodiscard]] std::string usageProblem(const CLI::App& reached, const CLI::ParseError& error);

}  // namespace haptolith
