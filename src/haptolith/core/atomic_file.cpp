#include "haptolith/core/atomic_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "haptolith/core/error.h"

namespace haptolith {

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)) {
  // The extension stays last, so that a program that chooses the format by it can write here.
  temporary_ = path_;
  temporary_.replace_filename(
      fmt::format(".{}.part-{}{}", path_.stem().string(), getpid(), path_.extension().string()));
  if (std::filesystem::is_directory(path_)) {
    errno = EISDIR;
    fail("open");
  }
  if (std::filesystem::exists(path_) && !std::filesystem::is_regular_file(path_)) {
    // The rename would put a file in the place of /dev/null.
    throw Failure(fmt::format("cannot replace {}: not a regular file", path_.string()));
  }
  file_ = std::fopen(temporary_.c_str(), "wb");
  if (file_ == nullptr) {
    fail("create");
  }
}

AtomicFile::~AtomicFile() {
  if (file_ != nullptr) {
    std::fclose(file_);
  }
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void AtomicFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) {
    fail("write");
  }
}

void AtomicFile::commit() {
  if (std::fflush(file_) != 0 || fsync(fileno(file_)) != 0) {
    fail("write");
  }
  const bool closed = std::fclose(std::exchange(file_, nullptr)) == 0;
  if (!closed || std::rename(temporary_.c_str(), path_.c_str()) != 0) {
    fail("save");
  }
}

void AtomicFile::fail(const char* what) const {
  throw Failure(fmt::format("cannot {} {}: {}", what, path_.string(), std::strerror(errno)));
}

}  // namespace haptolith
