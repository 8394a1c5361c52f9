#include "haptolith/core/new_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

/// "out/" and "out" are one folder.
fs::path withoutSlash(const fs::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

fs::path besideOf(const fs::path& path, std::string_view what) {
  fs::path beside = path;
  return beside.replace_filename(fmt::format(".{}.{}-{}", path.filename().string(), what, getpid()));
}

void moveTo(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) {
    throw Failure(fmt::format("cannot save {}: {}", to.string(), error.message()));
  }
}

}  // namespace

NewFolder::NewFolder(const fs::path& path, bool replace) : path_(withoutSlash(path)), making_(besideOf(path_, "part")) {
  if (fs::exists(path_) && (!replace || !fs::is_directory(path_))) {
    throw Failure(fmt::format("{} exists already: choose another name", path_.string()));
  }
  std::error_code error;
  if (!fs::create_directory(making_, error)) {
    throw Failure(fmt::format("cannot create {}: {}", path_.string(), error.message()));
  }
}

NewFolder::~NewFolder() {
  std::error_code ignored;
  fs::remove_all(making_, ignored);
}

void NewFolder::write(const fs::path& name, std::string_view bytes) const {
  std::error_code error;
  fs::create_directories((making_ / name).parent_path(), error);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen((making_ / name).c_str(), "wb"), std::fclose);
  if (!file || std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size() || std::fflush(file.get()) != 0) {
    throw Failure(fmt::format("cannot write {}: {}", (path_ / name).string(), std::strerror(errno)));
  }
}

void NewFolder::commit() const {
  if (!fs::exists(path_)) {
    moveTo(making_, path_);
    return;
  }
  const fs::path before = besideOf(path_, "before");
  moveTo(path_, before);
  try {
    moveTo(making_, path_);
  } catch (...) {
    std::error_code ignored;
    fs::rename(before, path_, ignored);
    throw;
  }
  std::error_code ignored;
  fs::remove_all(before, ignored);
}

}  // namespace haptolith
