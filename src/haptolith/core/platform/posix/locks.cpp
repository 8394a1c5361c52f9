#include "haptolith/core/platform/locks.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "haptolith/core/error.h"

namespace haptolith {

FolderLock::FolderLock(const std::filesystem::path& folder)
    : file_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (file_.number() < 0) {
    throw Failure(fmt::format("cannot open {}: {}", folder.string(), std::strerror(errno)));
  }
  // Some network file systems have no locks: there it is held.
  held_ = flock(file_.number(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

// The lock belongs to the open file, not to the process, which would lose it when it closes another descriptor.
FileLock::FileLock(const std::filesystem::path& file)
    : file_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600)) {
  const int descriptor = file_.number();
  if (descriptor < 0) {
    throw Failure(fmt::format("cannot open {}: {}", file.string(), std::strerror(errno)));
  }
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  held_ = fcntl(descriptor, F_OFD_SETLK, &whole) == 0;
  if (!held_ && errno != EAGAIN && errno != EACCES) {
    throw Failure(fmt::format("cannot lock {}: {}", file.string(), std::strerror(errno)));
  }
  if (!held_) {
    std::array<char, 16> text{};
    const ssize_t size = pread(descriptor, text.data(), text.size(), 0);
    holder_.assign(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
    return;
  }
  const std::string process = std::to_string(getpid());
  // For messages only; a failed write is ignored.
  [[maybe_unused]] const bool written =
      ftruncate(descriptor, 0) == 0 && pwrite(descriptor, process.data(), process.size(), 0) > 0;
}

}  // namespace haptolith
