#include "haptolith/study/store/study_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/platform/files.h"
#include "haptolith/study/store/participant_code.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestRead = std::uintmax_t{64} << 20;

fs::path folderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// Returns the files of a folder, sorted by name; after an error, those read before it.
std::vector<fs::path> filesIn(const fs::path& folder, std::error_code& error) {
  std::vector<fs::path> files;
  fs::directory_iterator entry(folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    files.push_back(entry->path());
  }
  std::ranges::sort(files);
  return files;
}

/// Whether the file is a recording whose name begins with `beginning`. An interrupted recording has a dot before this
/// name and more characters after it.
bool isRecording(const fs::path& file, std::string_view beginning) {
  std::string name = file.filename().string();
  name.erase(0, name.starts_with('.') ? 1 : 0);
  return name.ends_with(".h5") && name.starts_with(beginning);
}

bool isRecordingOfCode(const fs::path& file, std::string_view code) {
  return isRecording(file, fmt::format("{}-", code));
}

bool isRecordingOfTrial(const fs::path& file, std::string_view trial) {
  return isRecording(file, fmt::format("{}-first.", trial)) || isRecording(file, fmt::format("{}-second.", trial));
}

/// Whether another study uses this folder for its recordings.
bool isShared(const fs::path& folder, const fs::path& study) {
  std::error_code error;
  const std::vector<fs::path> beside = filesIn(folderOf(study), error);
  return error || std::ranges::any_of(beside, [&](const fs::path& file) {
           std::error_code ignored;
           return file.filename() != study.filename() && recordingsFolder(file).filename() == folder.filename() &&
                  fs::is_regular_file(file, ignored) && !irreplaceable(file).empty();
         });
}

bool fileNames(const fs::path& file, std::string_view code) {
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(file, error)) || fs::file_size(file, error) > kLargestRead || error ||
      !irreplaceable(file).empty()) {
    return false;
  }
  std::ifstream stream(file, std::ios::binary);
  return namesCode(std::string(std::istreambuf_iterator<char>(stream), {}), code);
}

}  // namespace

fs::path recordingsFolder(const fs::path& study) {
  fs::path folder = study;
  folder.replace_extension();
  return folder += "-recordings";
}

std::vector<fs::path> recordingsOf(const fs::path& study, std::string_view code, std::span<const std::string> trials) {
  const fs::path folder = recordingsFolder(study);
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return {};
  }
  std::vector<fs::path> files = filesIn(folder, error);
  if (error) {
    throw Failure(fmt::format("cannot read {}: {}", folder.string(), error.message()));
  }
  const bool is_shared = isShared(folder, study);
  std::erase_if(files, [&](const fs::path& file) {
    const auto is_of = [&file](std::string_view trial) { return isRecordingOfTrial(file, trial); };
    return std::ranges::none_of(trials, is_of) && (is_shared || !isRecordingOfCode(file, code));
  });
  return files;
}

void deleteFiles(const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    std::error_code error;
    fs::remove(file, error);
    if (error) {
      throw Failure(fmt::format("cannot delete {}: {}", file.string(), error.message()));
    }
  }
  if (!files.empty()) {
    flushFolderToDisk(folderOf(files.front()));
  }
}

std::vector<fs::path> othersThatName(const fs::path& study, std::string_view code) {
  std::error_code ignored;
  std::vector<fs::path> found = filesIn(folderOf(study), ignored);
  std::erase_if(found, [&](const fs::path& file) {
    return !fs::is_directory(file / fmt::format("sub-{}", code), ignored) && !fileNames(file, code);
  });
  std::ranges::copy_if(filesIn(recordingsFolder(study), ignored), std::back_inserter(found),
                       [code](const fs::path& file) { return isRecordingOfCode(file, code); });
  return found;
}

}  // namespace haptolith
