#pragma once

#include <string_view>
#include <vector>

#include "haptolith/scene_file/toml/toml_reader.h"
#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// Reads the tables [[name]], each a question of a form.
/// @throws InvalidParameter for an invalid table, with file, line, key, value and valid values.
[[nodiscard]] std::vector<FormItem> readItems(const TomlReader& reader, std::string_view name);

/// Returns the items, after the scales of nasaTaskLoadIndex() if `wanted`.
[[nodiscard]] std::vector<FormItem> withTaskLoadIndex(bool wanted, std::vector<FormItem> items);

}  // namespace haptolith
