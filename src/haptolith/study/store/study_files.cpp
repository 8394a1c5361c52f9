#include "haptolith/study/store/study_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

#include "haptolith/core/atomic_file.h"
#include "haptolith/core/error.h"
#include "haptolith/study/store/participant_code.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestRead = std::uintmax_t{64} << 20;

fs::path folderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
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

std::vector<fs::path> recordingsOf(const fs::path& study, std::string_view code) {
  const fs::path folder = recordingsFolder(study);
  std::vector<fs::path> found;
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return found;
  }
  const std::string whole = fmt::format("{}-", code), cut_off = "." + whole;
  fs::directory_iterator entry(folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.ends_with(".h5") && (name.starts_with(whole) || name.starts_with(cut_off))) {
      found.push_back(entry->path());
    }
  }
  if (error) {
    throw Failure(fmt::format("cannot read {}: {}", folder.string(), error.message()));
  }
  std::ranges::sort(found);
  return found;
}

void deleteFiles(const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    std::error_code error;
    fs::remove(file, error);
    if (error) {
      throw Failure(fmt::format("cannot delete {}: {}", file.string(), error.message()));
    }
  }
  if (files.empty()) {
    return;
  }
  if (const int folder = open(folderOf(files.front()).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); folder >= 0) {
    fsync(folder);
    close(folder);
  }
}

std::vector<fs::path> othersThatName(const fs::path& study, std::string_view code) {
  std::vector<fs::path> found;
  std::error_code error;
  fs::directory_iterator entry(folderOf(study), error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    std::error_code ignored;
    if (fs::is_directory(entry->path() / fmt::format("sub-{}", code), ignored) || fileNames(entry->path(), code)) {
      found.push_back(entry->path());
    }
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace haptolith
