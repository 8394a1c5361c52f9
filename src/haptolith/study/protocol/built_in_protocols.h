#pragma once

#include <span>
#include <string_view>

namespace haptolith {

/// A file of protocols/ as it was when the program was built.
struct BuiltInProtocol {
  std::string_view name;  ///< the file's, without .toml
  std::string_view text;
};

/// In the order of their names. The build writes this function: cmake/EmbedToml.cmake.
[[nodiscard]] std::span<const BuiltInProtocol> builtInProtocols();

}  // namespace haptolith
