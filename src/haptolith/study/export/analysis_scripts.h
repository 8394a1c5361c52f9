#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "haptolith/core/files/atomic_file.h"

namespace haptolith {

/// A file of analysis/ as it was when the program was built: it makes the numbers of `study figure` again from an
/// export.
struct AnalysisScript {
  std::string_view name;  ///< "analysis.py"
  std::string_view text;
};

/// In the order of their names. The build writes this function: cmake/EmbedToml.cmake.
[[nodiscard]] std::span<const AnalysisScript> analysisScripts();

/// Where a script for this table is written: friction-analysis.py beside friction.csv, which it then reads by itself.
[[nodiscard]] std::filesystem::path scriptBeside(const std::filesystem::path& table, const AnalysisScript& script);

/// Writes all scripts beside a table. @throws Failure when one is there that may not be replaced, or cannot be written.
void writeAnalysisScripts(const std::filesystem::path& table, IfThere if_there);

}  // namespace haptolith
