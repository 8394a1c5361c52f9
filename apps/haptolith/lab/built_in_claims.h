#pragma once

#include <span>
#include <string_view>

namespace haptolith {

/// A file of validation/ as it was when the program was built.
struct BuiltInClaims {
  std::string_view name;  ///< the file's, without .toml
  std::string_view text;
};

/// The build writes this function: cmake/EmbedToml.cmake.
[[nodiscard]] std::span<const BuiltInClaims> builtInClaims();

}  // namespace haptolith
