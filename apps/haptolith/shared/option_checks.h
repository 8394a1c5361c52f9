#pragma once

#include <CLI/App.hpp>

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/scene_file/toml/file_keys.h"

namespace haptolith {

// What an option may be. A wrong value is refused in the program's own words, with the value and what would be valid:
// "--threads: 0 is not valid: must be a whole number, 1 to 256".

/// A finite number in `range`.
[[nodiscard]] CLI::Validator numberIn(const Range& range);

/// A whole number in `range`.
[[nodiscard]] CLI::Validator wholeNumberIn(const Range& range);

/// One of these words.
[[nodiscard]] CLI::Validator oneOf(const std::vector<std::string>& words);

/// The name of an output: not `-`, with which other programs mean standard output.
[[nodiscard]] CLI::Validator outputName();

/// What is wrong with `word`: "'dig' is not valid: must be press or stir; did you mean ...?".
[[nodiscard]] std::string notAmong(const std::vector<std::string>& words, const std::string& word);

/// One of the words of `table`, upper and lower case alike, read as the value that it stands for; for transform().
template <class Value>
[[nodiscard]] CLI::Validator wordOf(const std::map<std::string, Value>& table) {
  std::vector<std::string> words;
  words.reserve(table.size());
  for (const auto& [word, value] : table) {
    words.push_back(word);
  }
  const auto read = [table, words](std::string& text) -> std::string {
    const auto entry = table.find(std::string(currentWord(CLI::detail::to_lower(text))));
    if (entry == table.end()) {
      return notAmong(words, text);
    }
    text = std::to_string(static_cast<int>(entry->second));  // CLI11 reads an enumeration's value from its number
    return "";
  };
  return {read, CLI::detail::generate_set(words)};
}

/// What is wrong with the command line, in the program's own words, for an error of CLI11's; `reached` is the command
/// that the user reached.
[[nodiscard]] std::string usageProblem(const CLI::App& reached, const CLI::ParseError& error);

}  // namespace haptolith
