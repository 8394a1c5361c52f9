#include "shared/saved.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/pluralise.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

std::set<fs::path>& told() {
  static std::set<fs::path> paths;
  return paths;
}

/// Returns "24 KiB".
std::string sizeText(std::uintmax_t bytes) {
  constexpr double kKiB = 1024;
  const auto size = static_cast<double>(bytes);
  return size < kKiB          ? fmt::format("{} bytes", bytes)
         : size < kKiB * kKiB ? fmt::format("{:.0f} KiB", size / kKiB)
                              : fmt::format("{:.1f} MiB", size / (kKiB * kKiB));
}

/// Max. size of a table whose rows are counted; a trace of hours is not read again for that.
constexpr std::uintmax_t kMostCounted = 16UL << 20;

/// Returns the numbers of rows below the heading and of columns; lines that begin with # are comments.
std::string tableText(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::uint64_t lines = 0;
  std::ptrdiff_t columns = 0;
  const char separator = path.extension() == ".tsv" ? '\t' : ',';
  while (std::getline(file, line)) {
    if (!line.starts_with('#')) {
      columns = lines++ == 0 ? 1 + std::ranges::count(line, separator) : columns;
    }
  }
  return fmt::format("{} of {}", pluralise(lines == 0 ? 0 : lines - 1, "row"), pluralise(columns, "column"));
}

std::string whatIs(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    return pluralise(std::distance(fs::directory_iterator(path, ignored), fs::directory_iterator()), "file");
  }
  const std::string extension = path.extension().string();
  const std::uintmax_t size = fs::file_size(path, ignored);
  const bool is_table = extension == ".csv" || extension == ".tsv";
  if (is_table && size <= kMostCounted) {
    return tableText(path);
  }
  const char* kind = extension == ".svg" || extension == ".png"    ? "picture, "
                     : extension == ".mp4" || extension == ".webm" ? "film, "
                     : is_table                                    ? "table, "
                     : extension == ".html"                        ? "page, "
                     : irreplaceable(path) == "a recording"        ? "recording, "
                                                                   : "";
  return kind + sizeText(size);
}

}  // namespace

std::string savedText(const fs::path& path, std::string_view what) {
  told().insert(path);
  return fmt::format("saved {}: {}\n", path.string(), what);
}

std::string savedText() {
  std::string text;
  for (const fs::path& path : filesWritten()) {
    if (!told().contains(path) && irreplaceable(path) != "a study") {
      text += savedText(path, whatIs(path));
    }
  }
  return text;
}

}  // namespace haptolith
