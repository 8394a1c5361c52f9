#include "haptolith/core/platform/files.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

namespace haptolith {

namespace {

namespace fs = std::filesystem;

/// A relative path in these variables is ignored, as the XDG specification asks.
fs::path absolutePathIn(const char* variable) {
  const char* value = std::getenv(variable);
  const fs::path folder = value == nullptr ? "" : value;
  return folder.is_absolute() ? folder : fs::path();
}

fs::path homeFor(const char* variable, const char* below_home) {
  if (fs::path folder = absolutePathIn(variable); !folder.empty()) {
    return folder;
  }
  const fs::path home = absolutePathIn("HOME");
  std::error_code ignored;
  return fs::is_directory(home, ignored) ? home / below_home : fs::path();
}

}  // namespace

bool fillWithRandom(std::span<std::byte> bytes) noexcept {
  return getrandom(bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size());
}

int createNewFile(const fs::path& path, bool owner_only) noexcept {
  const mode_t mode = owner_only ? 0600 : 0666;  // less the umask
  return open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
}

std::FILE* streamOf(int descriptor) noexcept {
  return descriptor < 0 ? nullptr : fdopen(descriptor, "wb");
}

bool createFolder(const fs::path& path, bool owner_only) noexcept {
  return mkdir(path.c_str(), owner_only ? 0700 : 0777) == 0;
}

bool writeBytes(int descriptor, std::string_view bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) {
      continue;
    }
    if (written <= 0) {
      return false;
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

bool flushToDisk(int descriptor) noexcept {
  return fsync(descriptor) == 0;
}

bool flushToDisk(std::FILE* file) noexcept {
  return std::fflush(file) == 0 && flushToDisk(fileno(file));
}

bool closeFile(int descriptor) noexcept {
  return ::close(descriptor) == 0;
}

int copyOf(int descriptor) noexcept {
  return fcntl(descriptor, F_DUPFD_CLOEXEC, 3);
}

int openForReading(const fs::path& path) noexcept {
  return open(path.c_str(), O_RDONLY | O_CLOEXEC);
}

std::int64_t readAt(int descriptor, std::uint64_t offset, std::span<std::byte> into) noexcept {
  return pread(descriptor, into.data(), into.size(), static_cast<off_t>(offset));
}

std::optional<std::uint64_t> sizeOf(int descriptor) noexcept {
  struct stat now {};
  return fstat(descriptor, &now) == 0 ? std::optional(static_cast<std::uint64_t>(now.st_size)) : std::nullopt;
}

bool wasRemoved(int descriptor) noexcept {
  struct stat now {};
  return fstat(descriptor, &now) == 0 && now.st_nlink == 0;
}

// Memory takes any write, /dev/null only from a user who may open it.
void discardWrites(int descriptor) noexcept {
  if (const int nowhere = memfd_create("haptolith", MFD_CLOEXEC); nowhere >= 0) {
    dup2(nowhere, descriptor);
    ::close(nowhere);
  }
}

void flushFolderToDisk(const fs::path& folder) noexcept {
  if (const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); descriptor >= 0) {
    fsync(descriptor);
    ::close(descriptor);
  }
}

bool renameFile(const fs::path& made, const fs::path& name, bool replaces) noexcept {
  int result = renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, name.c_str(), replaces ? 0U : RENAME_NOREPLACE);
  if (result != 0 && errno == EINVAL && access(name.c_str(), F_OK) != 0) {  // a file system without NOREPLACE
    result = std::rename(made.c_str(), name.c_str());
  }
  if (result != 0) {
    return false;
  }
  flushFolderToDisk(name.has_parent_path() ? name.parent_path() : fs::path("."));
  return true;
}

std::optional<FileIdentity> identityOf(const fs::path& path) noexcept {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 ? std::optional(FileIdentity{status.st_dev, status.st_ino}) : std::nullopt;
}

void makeNewFilesPrivate() noexcept {
  umask(077);
}

fs::path cacheHome() {
  return homeFor("XDG_CACHE_HOME", ".cache");
}

fs::path stateHome() {
  return homeFor("XDG_STATE_HOME", ".local/state");
}

}  // namespace haptolith
