#include "haptolith/core/files/moved_file.h"

#include <fmt/format.h>

#include <mutex>
#include <set>
#include <system_error>
#include <utility>

namespace haptolith {

namespace {

namespace fs = std::filesystem;

struct Reports {
  std::mutex mutex;
  std::function<void(std::string_view)> report;
  std::set<fs::path> reported;
};

Reports& reports() {
  static Reports all;
  return all;
}

}  // namespace

fs::path currentPath(const fs::path& path) {
  std::error_code ignored;  // such as a name that is too long for any file
  if (path.parent_path().filename() != "scenarios" || fs::exists(path, ignored)) {
    return path;
  }
  const fs::path current = path.parent_path().parent_path() / "scenes" / path.filename();
  if (!fs::exists(current, ignored)) {
    return path;
  }
  const std::lock_guard lock(reports().mutex);
  if (reports().report && reports().reported.insert(path).second) {
    reports().report(fmt::format("{} is now {}", path.string(), current.string()));
  }
  return current;
}

void reportMovedFiles(std::function<void(std::string_view)> report) {
  const std::lock_guard lock(reports().mutex);
  reports().report = std::move(report);
}

}  // namespace haptolith
