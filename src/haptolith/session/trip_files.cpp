#include "haptolith/session/trip_files.h"

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/files/new_file_name.h"
#include "haptolith/core/files/user_folder.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/recording/recording_format.h"

namespace haptolith {

namespace {

/// Files of a run, together 0.5 MB: repeated trips do not fill the disk.
constexpr std::uint64_t kMostFiles = 20;
constexpr double kBetween_s = 1;

std::string inFront(std::string_view tool) {
  return tool.empty() ? "" : fmt::format("{}: ", tool);
}

/// @return the file's name. @throws Failure when it cannot be written.
std::string writeTripFile(const TripReport& report, std::string_view tool) {
  const std::filesystem::path folder = userStateFolder();  // else the current one
  if (std::error_code error; !folder.empty()) {
    std::filesystem::create_directories(folder, error);  // if that fails, the file reports why
  }
  std::string name = newFileName((folder / "haptolith-trip").string(), ".csv");
  AtomicFile file(name);
  std::string text =
      fmt::format("# at {:.3f} s: {}{}\n", report.time_s, inFront(tool), report.reason()) + csvHeader(tickColumns());
  for (std::size_t i = 0; i < report.count; ++i) {
    appendCsv(text, report.ticks[i]);
  }
  file.write(text);
  file.commit();
  return name;
}

}  // namespace

std::string TripFiles::tell(const TripReport& report, std::string_view tool, std::string_view problem) {
  if (files_ == kMostFiles && report.time_s < told_s_ + kBetween_s) {
    ++untold_;
    return {};
  }
  told_s_ = report.time_s;
  std::string where;
  if (untold_ > 0) {
    where = fmt::format("; {} before that", pluralise(std::exchange(untold_, 0), "more time"));
  }
  if (files_ < kMostFiles) {
    ++files_;
    try {
      where = fmt::format("; the last {} ticks are in {}{}", report.count, writeTripFile(report, tool),
                          files_ == kMostFiles ? ", the last such file of this run" : "");
    } catch (const Failure& failure) {
      where = fmt::format("; the last ticks could not be written: {}", failure.what());
    }
  }
  return fmt::format("safety trip at {:.3f} s: {}{}{}{}{}", report.time_s, inFront(tool), report.reason(),
                     problem.empty() ? "" : ": ", problem, where);
}

std::string TripFiles::rest() const {
  return untold_ > 0 ? fmt::format("safety trips: {}", pluralise(untold_, "more time")) : "";
}

}  // namespace haptolith
