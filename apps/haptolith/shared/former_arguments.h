#pragma once

#include <string>
#include <vector>

namespace haptolith {

/// Replaces commands and options of earlier versions by those of today, and reports each (onFormerName()). They
/// work for one minor version (CHANGELOG.md).
/// @param arguments  as of main(): the program comes first
[[nodiscard]] std::vector<std::string> currentArguments(std::vector<std::string> arguments);

}  // namespace haptolith
