#include "haptolith/lab/archive/report_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fstream>
#include <system_error>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/files/atomic_folder.h"
#include "haptolith/core/files/input_file.h"
#include "haptolith/lab/archive/json_differences.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kReportConditions = "conditions.json";
constexpr const char* kResults = "results";
constexpr std::uintmax_t kMostReportBytes = std::uintmax_t{16} << 20;

std::string textOf(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

void write(const fs::path& path, const Json& json, IfThere if_there) {
  AtomicFile file({path, if_there});
  file.write(textOf(json));
  file.commit();
}

Json read(const fs::path& path) {
  std::ifstream file = openInput(path, kMostReportBytes);
  Json json = Json::parse(file, nullptr, false);
  if (!json.is_object()) {
    throw Failure(fmt::format("{} is not a JSON object", path.string()));
  }
  return json;
}

}  // namespace

ReportFolder::ReportFolder(const fs::path& path, const Json& conditions, ReportThere if_there,
                           std::vector<std::string> pages)
    : path_(path.has_filename() ? path : path.parent_path()), pages_(std::move(pages)) {
  const Json now = Json::parse(textOf(conditions));  // values that are not finite become null, as in the file
  if (!fs::exists(fs::symlink_status(path_))) {
    const AtomicFolder made(path_);
    made.write(kReportConditions, textOf(now));
    made.commit();
    lock();
  } else {
    if (if_there == ReportThere::kRefuse) {
      throw Failure(
          fmt::format("{} already exists: add --resume to continue the report in it, --overwrite to restart it, or "
                      "choose another name with --out",
                      path_.string()));
    }
    const bool holds_report = fs::exists(path_ / kReportConditions);
    if (!holds_report && !(fs::is_directory(path_) && fs::is_empty(path_))) {
      throw Failure(fmt::format("{} does not contain a report: choose another name with --out", path_.string()));
    }
    lock();
    if (!holds_report || if_there == ReportThere::kReplace) {
      removeReport();
      write(path_ / kReportConditions, now, IfThere::kReplace);
    } else if (const auto different = differences(read(path_ / kReportConditions), now, "{} was {} and is {}");
               !different.empty()) {
      throw Failure(
          fmt::format("{} contains a report with other conditions: {}. Resume it with the same conditions, or choose "
                      "another name with --out",
                      path_.string(), fmt::join(different, "; ")));
    }
  }
  fs::create_directories(path_ / kResults);
}

/// Removes the files of a report, and no other files.
void ReportFolder::removeReport() const {
  std::vector<fs::path> files;
  for (const std::string& page : pages_) {
    files.push_back(path_ / page);
  }
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_ / kResults, ignored)) {
    const fs::path extension = entry.path().extension();
    if (extension == ".json" || extension == ".png") {
      files.push_back(entry.path());
    }
  }
  for (const fs::path& file : files) {
    std::error_code error;
    fs::remove(file, error);
    if (error) {
      throw Failure(fmt::format("cannot remove {}: {}", file.string(), error.message()));
    }
  }
}

fs::path ReportFolder::resultFile(const std::string& name) const {
  return path_ / kResults / (name + ".json");
}

fs::path ReportFolder::figure(const std::string& name) const {
  return path_ / kResults / (name + ".png");
}

std::optional<Json> ReportFolder::result(const std::string& name) const {
  const fs::path file = resultFile(name);
  return fs::exists(file) ? std::optional(read(file)) : std::nullopt;
}

void ReportFolder::save(const std::string& name, const Json& result) const {
  write(resultFile(name), result, IfThere::kRefuse);
}

void ReportFolder::lock() {
  locked_ = FolderLock(path_);
  if (!locked_.held()) {
    throw Failure(
        fmt::format("another process writes the report in {}: wait until it ends, or choose another name with --out",
                    path_.string()));
  }
}

}  // namespace haptolith
