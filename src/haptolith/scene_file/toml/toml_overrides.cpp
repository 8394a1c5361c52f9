#include <fmt/format.h>
#include <fmt/ranges.h>

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
  std::string list = {}, part = {};  ///< "tools.left.hand.motion=press": list tools, part left
};

constexpr std::string_view kOverrideValid =
    "table.key=value, for example bed.threads=4, or tools.NAME.key=value (docs/reference/scenes.md has the keys)";

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
  constexpr std::ptrdiff_t kMostDots = 3;
  const std::ptrdiff_t dots = std::ranges::count(name, '.');
  std::string list, part, rest = name;
  if (dots > 1) {
    const std::size_t first = name.find('.'), second = name.find('.', first + 1);
    list = name.substr(0, first);
    part = name.substr(first + 1, second - first - 1);
    rest = name.substr(second + 1);
  }
  if (equals == std::string::npos || name.empty() || (list + rest).find_first_not_of(kKey) != std::string::npos ||
      dots > kMostDots || (dots > 1 && (list.empty() || part.empty()))) {
    const InvalidParameter wrong("override", fmt::format("'{}'", shortened(text)), std::string(kOverrideValid));
    throw TomlError(wrong.what(), 0, wrong);
  }
  const std::string current(currentNameReported(NameKind::kKey, rest));
  const std::size_t dot = current.find('.');
  return {.table = dot == std::string::npos ? "" : current.substr(0, dot),
          .key = dot == std::string::npos ? current : current.substr(dot + 1),
          .value = trimmed(std::string_view(text).substr(equals + 1)),
          .list = list,
          .part = part};
}

/// A table with the one key; a value that is no TOML is text: P3 need not be "P3".
toml::table tableWith(const Override& given, std::string_view source) {
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

/// The table of [[list]] that has this `name`. In a change there is one for every name that it speaks of.
toml::table& TomlReader::partNamed(std::string_view list, std::string_view name) {
  if (is_change_ && !table_->contains(list)) {
    table_->insert(list, toml::array());
  }
  toml::array* parts = (*table_)[list].as_array();
  std::vector<std::string> names;
  if (parts != nullptr) {
    for (toml::node& node : *parts) {
      toml::table* part = node.as_table();
      names.push_back(part == nullptr                     ? ""
                      : part->get_as<std::string>("name") ? **part->get_as<std::string>("name")
                                                          : "");
      if (part != nullptr && names.back() == name) {
        return *part;
      }
    }
  }
  if (parts != nullptr && is_change_) {
    parts->push_back(toml::table{{"name", name}});
    return *parts->back().as_table();
  }
  const InvalidParameter wrong("override", fmt::format("'{}.{}'", list, name),
                               names.empty()
                                   ? fmt::format("{}: {} has no [[{}]]", kOverrideValid, path_.string(), list)
                                   : fmt::format("one of the {} that are there: {}", list, fmt::join(names, ", ")));
  throw TomlError(wrong.what(), 0, wrong);
}

void TomlReader::takeOverrides(std::span<const std::string> overrides, std::span<const RivalKeys> rivals) {
  std::vector<std::pair<std::string, std::string>> overridden;
  for (const std::string& text : overrides) {
    const Override given = parsedOverride(text);
    toml::table one = tableWith(given, fmt::format("override {}", shortened(text)));
    toml::table& whole = given.list.empty() ? *table_ : partNamed(given.list, given.part);
    if (!given.table.empty() && !whole.contains(given.table)) {
      whole.insert(given.table, toml::table());
    }
    toml::table* at = given.table.empty() ? &whole : whole[given.table].as_table();
    if (at == nullptr) {
      refuse(static_cast<int>(whole.get(given.table)->source().begin.line),
             fmt::format("{} is not valid: must be a table, [{}]", given.table, given.table));
    }
    if (const toml::node* before = given.list.empty() ? nullptr : at->get(given.key); before && isOverride(*before)) {
      const InvalidParameter wrong("override", fmt::format("'{}'", shortened(text)),
                                   fmt::format("given once: {}.{} is given twice", given.list, given.part));
      throw TomlError(wrong.what(), 0, wrong);
    }
    one.get("value")->visit([&](auto& value) { at->insert_or_assign(given.key, std::move(value)); });  // and its source
    if (given.list.empty()) {
      overridden.emplace_back(given.table, given.key);
    }
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
