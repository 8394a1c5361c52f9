#include "haptolith/core/platform/locks.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <io.h>
#include <process.h>
#include <share.h>
#include <sys/stat.h>

#include <array>
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

// Others may read it meanwhile, and open it to write only when it is closed.
FileLock::FileLock(const std::filesystem::path& file) {
  constexpr int kBoth = _S_IREAD | _S_IWRITE;
  int descriptor = -1;
  int error = _wsopen_s(&descriptor, file.c_str(), _O_RDWR | _O_CREAT | _O_BINARY | _O_NOINHERIT, _SH_DENYWR, kBoth);
  held_ = descriptor >= 0;
  if (!held_ && error == EACCES) {
    error = _wsopen_s(&descriptor, file.c_str(), _O_RDONLY | _O_BINARY | _O_NOINHERIT, _SH_DENYNO, kBoth);
  }
  if (descriptor < 0) {
    throw Failure(fmt::format("cannot open {}: {}", file.string(), std::strerror(error)));
  }
  file_ = Descriptor(descriptor);
  if (!held_) {
    std::array<char, 16> text{};
    const int size = _read(descriptor, text.data(), static_cast<unsigned>(text.size()));
    holder_.assign(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
    return;
  }
  const std::string process = std::to_string(_getpid());
  // For messages only; a failed write is ignored.
  [[maybe_unused]] const bool written = _chsize_s(descriptor, 0) == 0 && writeBytes(descriptor, process);
}

}  // namespace haptolith
