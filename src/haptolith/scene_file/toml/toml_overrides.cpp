#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "haptolith/core/former_names.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/scene_file/toml/toml_reader.h"

namespace haptolith {

namespace {

/// "bed.threads=4", taken apart.
struct Override {
  std::string table, key, value;
};

constexpr std::string_view kOverrideValid =
    "table.key=value, for example bed.threads=4 (docs/reference/scenes.md has the keys)";

Override parsedOverride(const std::string& text) {
  const auto trimmed = [](std::string_view part) {
    const auto first = part.find_first_not_of(" \t\r\n");
    return first == std::string_view::npos
               ? std::string()
               : std::string(part.substr(first, part.find_last_not_of(" \t\r\n") - first + 1));
  };
  const std::size_t equals = text.find('=');
  const std::string name = trimmed(std::string_view(text).substr(0, equals));
  constexpr std::string_view kKey = "abcdefghijklmnopqrstuvwxyz0123456789_.";
  if (equals == std::string::npos || name.empty() || name.find_first_not_of(kKey) != std::string::npos ||
      std::ranges::count(name, '.') > 1) {
    const InvalidParameter wrong("override", fmt::format("'{}'", shortened(text)), std::string(kOverrideValid));
    throw TomlError(wrong.what(), 0, wrong);
  }
  const std::string current(currentNameReported(NameKind::kKey, name));
  const std::size_t dot = current.find('.');
  return {.table = dot == std::string::npos ? "" : current.substr(0, dot),
          .key = dot == std::string::npos ? current : current.substr(dot + 1),
          .value = trimmed(std::string_view(text).substr(equals + 1))};
}

/// A table with the one key; a value that is no TOML is text: P3 need not be "P3".
toml::table tableOf(const Override& given, std::string_view source) {
  try {
    toml::table table = toml::parse(fmt::format("value = {}\n", given.value), source);
    if (table.size() == 1) {
      return table;
    }
  } catch (const toml::parse_error&) {  // text
  }
  std::string quoted;
  for (const char c : given.value) {
    const bool plain = static_cast<unsigned char>(c) >= ' ' && c != '"' && c != '\\' && c != '\x7F';
    quoted += plain ? std::string(1, c) : fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
  }
  try {
    return toml::parse(fmt::format("value = \"{}\"\n", quoted), source);
  } catch (const toml::parse_error&) {
    const InvalidParameter wrong("override", fmt::format("'{}'", given.key), "a key with a value in UTF-8");
    throw TomlError(wrong.what(), 0, wrong);
  }
}

}  // namespace

void TomlReader::takeOverrides(std::span<const std::string> overrides, std::span<const RivalKeys> rivals) {
  std::vector<std::pair<std::string, std::string>> overridden;
  for (const std::string& text : overrides) {
    const Override given = parsedOverride(text);
    toml::table one = tableOf(given, fmt::format("override {}", shortened(text)));
    if (!given.table.empty() && find("", given.table) == nullptr) {
      table_->insert(given.table, toml::table());
    }
    toml::table* at = given.table.empty() ? table_.get() : (*table_)[given.table].as_table();
    if (at == nullptr) {
      refuse(lineOf("", given.table), fmt::format("{} is not valid: must be a table, [{}]", given.table, given.table));
    }
    one.get("value")->visit([&](auto& value) { at->insert_or_assign(given.key, std::move(value)); });  // and its source
    overridden.emplace_back(given.table, given.key);
  }
  const auto is_overridden = [&](std::string_view table, std::string_view key) {
    return std::ranges::any_of(overridden, [&](const auto& name) { return name.first == table && name.second == key; });
  };
  const auto pass_over = [&](std::string_view table, std::string_view key) {
    toml::table* const at = table.empty() ? table_.get() : (*table_)[table].as_table();
    if (at != nullptr && !is_overridden(table, key)) {
      at->erase(key);
    }
  };
  for (const RivalKeys& pair : rivals) {
    if (is_overridden(pair.table, pair.one)) {
      pass_over(pair.table, pair.other);
    }
    if (is_overridden(pair.table, pair.other)) {
      pass_over(pair.table, pair.one);
    }
  }
}

void TomlReader::passOver(std::string_view table, const std::function<bool(std::string_view key)>& which) {
  toml::table* const at = table.empty() ? table_.get() : (*table_)[table].as_table();
  if (at == nullptr) {
    return;
  }
  std::vector<std::string> passed;
  for (const auto& [key, node] : *at) {
    if (which(key.str()) && !isOverride(node)) {
      passed.emplace_back(key.str());
    }
  }
  for (const std::string& key : passed) {
    at->erase(key);
  }
}

}  // namespace haptolith
