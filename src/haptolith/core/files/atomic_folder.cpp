#include "haptolith/core/files/atomic_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "haptolith/core/error.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/platform/files.h"

namespace haptolith {

namespace {

namespace fs = std::filesystem;

/// "out/" and "out" are one folder.
fs::path withoutSlash(const fs::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

/// Names may contain text from users.
void requireInside(const fs::path& name) {
  const bool inside = !name.empty() && name.is_relative() &&
                      std::ranges::none_of(name, [](const fs::path& part) { return part == ".." || part == "."; });
  if (!inside || name.string().find('\0') != std::string::npos) {
    throw Failure(
        fmt::format("cannot write {}: must be the name of a file inside its folder", inQuotes(name.string())));
  }
}

}  // namespace

AtomicFolder::AtomicFolder(const fs::path& path, IfThere if_there, Readers readers)
    : path_(withoutSlash(path)), making_(temporaryBeside(path_, "part")), if_there_(if_there), readers_(readers) {
  if (fs::exists(fs::symlink_status(path_)) && (if_there == IfThere::kRefuse || !fs::is_directory(path_))) {
    throw Failure(fmt::format("{} already exists: choose another name", path_.string()));
  }
  if (!createFolder(making_, readers == Readers::kOwner)) {
    throw Failure(fmt::format("cannot create {}: {}", path_.string(), std::strerror(errno)));
  }
}

AtomicFolder::~AtomicFolder() {
  std::error_code ignored;
  fs::remove_all(making_, ignored);
}

void AtomicFolder::write(const fs::path& name, std::string_view bytes) const {
  requireInside(name);
  std::error_code error;
  fs::create_directories((making_ / name).parent_path(), error);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(streamOf(makeNewFile(making_ / name, readers_)),
                                                             std::fclose);
  if (!file || std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size() || std::fflush(file.get()) != 0) {
    throw Failure(fmt::format("cannot write {}: {}", (path_ / name).string(), std::strerror(errno)));
  }
}

void AtomicFolder::commit() const {
  if (if_there_ == IfThere::kRefuse || !fs::exists(path_)) {
    giveName(making_, path_, IfThere::kRefuse);
    return;
  }
  const fs::path before = temporaryBeside(path_, "before");
  giveName(path_, before, IfThere::kRefuse);
  try {
    giveName(making_, path_, IfThere::kRefuse);
  } catch (...) {
    std::error_code ignored;
    fs::rename(before, path_, ignored);
    throw;
  }
  std::error_code ignored;
  fs::remove_all(before, ignored);
}

}  // namespace haptolith
