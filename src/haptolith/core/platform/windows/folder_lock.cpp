#include "haptolith/core/platform/folder_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <io.h>
#include <share.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>

#include "haptolith/core/error.h"

namespace haptolith {

// A file in the folder that no other process can open meanwhile, and that vanishes when it is closed.
FolderLock::FolderLock(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / ".lock";
  int descriptor = -1;
  const int error = _wsopen_s(&descriptor, file.c_str(), _O_RDWR | _O_CREAT | _O_NOINHERIT | _O_TEMPORARY, _SH_DENYRW,
                              _S_IREAD | _S_IWRITE);
  if (descriptor < 0 && error != EACCES) {
    throw Failure(fmt::format("cannot open {}: {}", folder.string(), std::strerror(error)));
  }
  file_ = Descriptor(descriptor);
  held_ = descriptor >= 0;
}

}  // namespace haptolith
