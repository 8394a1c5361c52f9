#include "haptolith/study/store/runner_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

/// Returns " (process 1234)", or nothing if the file has no number.
std::string holderOf(int descriptor) {
  std::array<char, 16> text{};
  const ssize_t size = pread(descriptor, text.data(), text.size(), 0);
  return size > 0 ? fmt::format(" (process {})", std::string_view(text.data(), static_cast<std::size_t>(size))) : "";
}

}  // namespace

RunnerLock::RunnerLock(const std::filesystem::path& study) {
  const std::string path = study.string() + "-lock";
  descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (descriptor_ < 0) {
    throw Failure(fmt::format("cannot run {}: cannot open {}: {}", study.string(), path, std::strerror(errno)));
  }
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  if (fcntl(descriptor_, F_OFD_SETLK, &whole) != 0) {
    const int why = errno;
    const std::string holder = holderOf(descriptor_);
    close(descriptor_);
    if (why == EAGAIN || why == EACCES) {
      throw Failure(
          fmt::format("cannot run {}: another program{} already runs it; wait until it ends (`haptolith study status` "
                      "works meanwhile)",
                      study.string(), holder));
    }
    throw Failure(fmt::format("cannot run {}: cannot lock {}: {}", study.string(), path, std::strerror(why)));
  }
  const std::string process = std::to_string(getpid());
  // For messages only; a failed write is ignored.
  [[maybe_unused]] const bool told =
      ftruncate(descriptor_, 0) == 0 && pwrite(descriptor_, process.data(), process.size(), 0) > 0;
}

RunnerLock::~RunnerLock() {
  close(descriptor_);
}

}  // namespace haptolith
