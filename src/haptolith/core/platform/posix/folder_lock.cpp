#include "haptolith/core/platform/folder_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

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

}  // namespace haptolith
