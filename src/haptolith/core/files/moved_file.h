#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace haptolith {

/// The path of a file to read: `scenarios/dig.toml`, where version 0.2 and earlier had it, becomes `scenes/dig.toml`
/// if only that exists. Other paths stay as they are. Not for the tick.
[[nodiscard]] std::filesystem::path currentPath(const std::filesystem::path& path);

/// @param report  called once for each path that currentPath() changes, with a line for a person
void reportMovedFiles(std::function<void(std::string_view)> report);

}  // namespace haptolith
