#include "haptolith/lab/catalogue/option_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <variant>

#include "haptolith/core/error.h"
#include "haptolith/core/former_names.h"
#include "haptolith/core/nearest_word.h"
#include "haptolith/core/overloaded.h"

namespace haptolith {

namespace {

std::string shown(const toml::node& node) {
  std::ostringstream text;
  node.visit([&text](const auto& value) { text << value; });
  return text.str();
}

[[noreturn]] void refuse(const std::string& key, const toml::node& node, const std::string& valid) {
  throw InvalidParameter(key, shown(node), valid);
}

double numberIn(const std::string& key, const toml::node& node) {
  const auto number = node.value<double>();
  if (!node.is_number() || !std::isfinite(*number)) {
    refuse(key, node, "a number");
  }
  return *number;
}

/// Returns the key of today for one that earlier versions had.
std::string currentKey(std::string_view key) {
  constexpr std::string_view kTable = "lab.";
  const std::string full = fmt::format("{}{}", kTable, key);
  return std::string(currentNameReported(NameKind::kKey, full).substr(kTable.size()));
}

}  // namespace

void setOption(const LabOption& option, const toml::node& node) {
  const std::string& key = option.key;
  std::visit(
      Overloaded{[&](const LabOption::Number& set) { set(numberIn(key, node)); },
                 [&](const LabOption::List& set) {
                   std::vector<double> numbers;
                   if (const toml::array* array = node.as_array()) {
                     for (const toml::node& element : *array) {
                       numbers.push_back(numberIn(key, element));
                     }
                   } else {
                     numbers.push_back(numberIn(key, node));
                   }
                   set(numbers);
                 },
                 [&](const LabOption::Switch& set) {
                   const auto on = node.value_exact<bool>();
                   if (!on) {
                     refuse(key, node, "true or false");
                   }
                   if (*on) {
                     set();
                   }
                 },
                 [&](const LabOption::Count& count) {
                   const auto given = node.value_exact<std::int64_t>();
                   if (!given || !count.valid.contains(static_cast<double>(*given))) {
                     refuse(key, node, "a whole number, " + count.valid.text());
                   }
                   count.set(*given);
                 },
                 [&](const LabOption::Word& word) {
                   auto given = word.words.empty() && node.is_number() ? std::optional(shown(node))
                                                                       : node.value_exact<std::string>();
                   if (given && !word.words.empty()) {
                     given = std::string(currentNameReported(NameKind::kWord, *given));
                   }
                   if (!given || (!word.words.empty() && std::ranges::find(word.words, *given) == word.words.end())) {
                     refuse(key, node,
                            word.words.empty() ? "a text" : fmt::format("{}", fmt::join(word.words, " or ")));
                   }
                   word.set(*given);
                 }},
      option.set);
}

void setOptions(const toml::table& table, const std::vector<LabOption>& options) {
  for (const auto& [name, node] : table) {
    const std::string key = currentKey(name.str());
    const auto option = std::ranges::find(options, key, &LabOption::key);
    if (option == options.end()) {
      std::vector<std::string_view> known;
      known.reserve(options.size());
      for (const LabOption& other : options) {
        known.push_back(other.key);
      }
      const std::string_view nearest = nearestWord(key, known);
      throw InvalidParameter(key, shown(node),
                             fmt::format("one of the keys {}{}", fmt::join(known, ", "),
                                         nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
    }
    setOption(*option, node);
  }
}

void readOptions(std::string_view text, const std::vector<LabOption>& options) {
  toml::table table;
  try {
    table = toml::parse(text, std::string_view("options"));
  } catch (const toml::parse_error& error) {
    throw InvalidParameter("options", fmt::format("line {}", error.source().begin.line),
                           fmt::format("TOML: {}", error.description()));
  }
  setOptions(table, options);
}

}  // namespace haptolith
