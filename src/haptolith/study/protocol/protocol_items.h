#pragma once

#include <string_view>
#include <vector>

#include "haptolith/scene_file/toml/toml_reader.h"
#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// Reads the tables [[name]], each a question of a form.
/// @throws InvalidParameter for what is not valid in these, with file, line, key, value and what would be valid.
[[nodiscard]] std::vector<FormItem> readItems(const TomlReader& reader, std::string_view name);

/// Those after the scales of nasaTaskLoadIndex(), where these are wanted.
[[nodiscard]] std::vector<FormItem> withTaskLoadIndex(bool wanted, std::vector<FormItem> items);

}  // namespace haptolith
