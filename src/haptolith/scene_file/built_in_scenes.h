#pragma once

#include <span>
#include <string_view>

namespace haptolith {

/// A file of scenes/ as it was when the program was built.
struct BuiltInScene {
  std::string_view name;  ///< the file's, without .toml
  std::string_view text;
};

/// In the order of their names. The build writes this function: cmake/EmbedToml.cmake.
[[nodiscard]] std::span<const BuiltInScene> builtInScenes();

}  // namespace haptolith
