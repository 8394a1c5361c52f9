#pragma once

#include <filesystem>

namespace haptolith {

/// The path of a file to read: `scenarios/paper.toml`, where version 0.2 and earlier had it, becomes
/// `scenes/icra2021.toml` if only that exists. Other paths stay as they are. The change is reported
/// (onFormerName()). Not for the tick.
[[nodiscard]] std::filesystem::path currentPath(const std::filesystem::path& path);

}  // namespace haptolith
