#pragma once

#include <span>
#include <string_view>

namespace haptolith {

/// A file of tools/ as it was when the program was built.
struct BuiltInTool {
  std::string_view name;  ///< the file's, without .obj
  std::string_view text;  ///< OBJ in mm; what the hand holds is at its origin
};

/// In the order of their names. The build writes this function: cmake/EmbedToml.cmake.
[[nodiscard]] std::span<const BuiltInTool> builtInTools();

}  // namespace haptolith
