#pragma once

#include <span>
#include <string_view>

namespace haptolith {

/// A file of soils/ as it was when the program was built.
struct BuiltInSoil {
  std::string_view name;  ///< the file's, without .toml; the `name` in the file is the same
  std::string_view text;
};

/// In the order of their names. The build writes this function: cmake/EmbedToml.cmake.
[[nodiscard]] std::span<const BuiltInSoil> builtInSoils();

}  // namespace haptolith
