#pragma once

#include <span>
#include <string_view>

namespace haptolith {

/// A file of trainings/ as it was when the program was built.
struct BuiltInTraining {
  std::string_view name;  ///< the file's
  std::string_view text;  ///< JSON: training_file.h
};

/// In the order of their names. The build writes this function: cmake/EmbedToml.cmake.
[[nodiscard]] std::span<const BuiltInTraining> builtInTrainings();

}  // namespace haptolith
