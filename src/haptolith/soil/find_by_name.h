#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {

/// The entry of `table` whose `name` is `name`, upper and lower case alike. `key` names the parameter in the message.
/// @throws InvalidParameter listing the valid names.
template <class Table>
const auto& findByName(const Table& table, std::string_view key, std::string_view name) {
  const auto same_letter = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  std::vector<std::string_view> valid;
  for (const auto& entry : table) {
    if (std::equal(name.begin(), name.end(), entry.name.begin(), entry.name.end(), same_letter)) {
      return entry;
    }
    valid.push_back(entry.name);
  }
  throw InvalidParameter(std::string(key), fmt::format("'{}'", name), fmt::format("one of {}", fmt::join(valid, ", ")));
}

}  // namespace haptolith
